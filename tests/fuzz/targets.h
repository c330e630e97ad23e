#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace surfcast::fuzz {

using Bytes = std::span<const std::byte>;

// What reads bytes of strangers, each as a function that takes any bytes. Errors are values; a fault stops the program.

void read_hello(Bytes bytes);    ///< the first bytes of a framed connection
void read_frames(Bytes bytes);   ///< the frames that follow
void read_request(Bytes bytes);  ///< a message of a client, and the checks of what it asks for
void read_answer(Bytes bytes);   ///< a message of a server, as a client takes it
void read_depth(Bytes bytes);    ///< the depth of a frame, as a client warps by it
void read_route(Bytes bytes);    ///< the target of an HTTP request
void read_query(Bytes bytes);    ///< the query of a picture, a pick, a profile or points

void read_scan(Bytes bytes);       ///< LAS, LAZ, PLY, PCD, PTX, Draco, E57, pnts, Expe, text: by content
void read_grid(Bytes bytes);       ///< NRRD, MetaImage, VTK with points too, NIfTI: by content
void read_ellipsoid(Bytes bytes);  ///< NRRD, VTK, NIfTI and MRtrix of tensors, tables
void read_mesh(Bytes bytes);       ///< OBJ, glTF, GLB, PLY with faces, STL
void read_gaussian(Bytes bytes);   ///< PLY, SPZ, SOG: by content
void read_splat(Bytes bytes);      ///< .splat, which has no signature

void read_model(Bytes bytes);           ///< a model file, its blocks included
void read_gaussian_block(Bytes bytes);  ///< the block of a model, behind its checksum
void read_brick(Bytes bytes);

struct Target {
  std::string_view name;
  void (*run)(Bytes bytes);
};

inline constexpr std::array kTargets{
    Target{"hello", read_hello},         Target{"frames", read_frames}, Target{"request", read_request},
    Target{"answer", read_answer},       Target{"depth", read_depth},   Target{"route", read_route},
    Target{"query", read_query},         Target{"scan", read_scan},     Target{"grid", read_grid},
    Target{"ellipsoid", read_ellipsoid}, Target{"mesh", read_mesh},     Target{"gaussian", read_gaussian},
    Target{"splat", read_splat},         Target{"model", read_model},   Target{"gaussian_block", read_gaussian_block},
    Target{"brick", read_brick}};

}  // namespace surfcast::fuzz
