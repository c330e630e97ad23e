#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// True if text begins like an ESRI ASCII grid: with `ncols` and a number.
bool looks_like_ascii_grid(std::string_view text);

/// The file beside an ESRI ASCII grid that states its coordinate system as WKT: `NAME.prj` of `NAME.asc`.
std::filesystem::path projection_file(const std::filesystem::path& grid);

/// Reads the elevations of an ESRI ASCII grid (`ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or
/// `yllcenter`, `cellsize` or `dx` and `dy`, `nodata_value`): a point in the middle of each cell. The first row is the
/// northern one. Cells without a value have no point. `path`: of the grid, whose projection_file is read if it exists.
Result<std::unique_ptr<RowSource>> ascii_grid_rows(std::span<const std::byte> bytes, const std::filesystem::path& path);

/// Reads a Draco file, a point cloud or a mesh: positions, normals and colours. All other attributes become scalars,
/// named as in the file's metadata. `z_up` is decided as for PLY (see up_axis.h).
Result<std::unique_ptr<RowSource>> draco_rows(std::span<const std::byte> bytes, const DecodingLimit& limit);

/// Reads all scans of an E57 file (ASTM E2807-11) in the coordinates of the file: poses are applied, spherical
/// coordinates converted (elevation counts from the xy plane), points that are marked invalid become NaN. A value that
/// only some scans have is zero in the others, a colour grey. Colours have 8 bits, or 16 if one scan has more. Texts of
/// points and pictures are left out; pictures are noted.
Result<std::unique_ptr<RowSource>> e57_rows(std::span<const std::byte> bytes);

/// Reads an Entwine point tile folder (EPT 1.0): tiles as LAZ, binary or Zstandard, in the order of their keys as
/// numbers. Of a selection with bounds only the tiles and pages of the hierarchy that meet them. `path`: its ept.json.
Result<std::unique_ptr<RowSource>> ept_rows(const std::filesystem::path& path, const DecodingLimit& limit,
                                            const Selection& selection);

/// Reads an Expe point set (Pointshop3D), binary: a text header, then records of position, radius, normal and colour in
/// the order in which the header names them. Floats of 4 bytes, colours of 4 (red, green, blue, alpha). Other
/// properties are skipped by their stated size. The text variant is refused by name.
Result<std::unique_ptr<RowSource>> expe_rows(std::span<const std::byte> bytes);

/// Reads a PCD file (Point Cloud Library): ascii, binary or binary_compressed. Organised clouds come from depth cameras
/// and are y-up; others are z-up, as in robotics.
Result<std::unique_ptr<RowSource>> pcd_rows(std::span<const std::byte> bytes, const DecodingLimit& limit);

/// Reads the element "vertex" of a PLY file, ascii or binary in either byte order. Other elements are checked for
/// completeness and ignored. PLY is a graphics format: `z_up` is false unless the points look like a survey (see
/// up_axis.h). Files of 3D Gaussians are rejected.
Result<std::unique_ptr<RowSource>> ply_rows(std::span<const std::byte> bytes);

/// The same for any element, of any file: columns of the properties that are not lists.
Result<std::unique_ptr<RowSource>> ply_element_rows(std::span<const std::byte> bytes, std::string_view element);

/// True if text begins like a PTX file: two lines with one integer each.
bool looks_like_ptx(std::string_view text);

/// Reads a PTX file: one or more scanner stations, each a grid of points in the scanner's frame with a matrix that
/// transforms them to world coordinates. Rays without an echo, stored as 0 0 0, become NaN points. The sensor position
/// is set if there is exactly one station. Intensities are 0 to 1.
Result<std::unique_ptr<RowSource>> ptx_rows(std::span<const std::byte> bytes);

/// Reads points from text: XYZ, PTS, CSV.
/// - Numbers are separated by spaces, tabs, commas or semicolons. In a file with semicolons a comma is no separator, so
///   decimal commas are an error instead of being read as two numbers.
/// - Lines that begin with # or // are comments. The last one before the numbers is a header if it has one word for
///   each column, among them x, y and z.
/// - A first line with a single integer is the number of rows (PTS). Further blocks with their own count may follow.
/// - Every row must have the same number of columns as the first.
/// - Without a header, columns are guessed (column_names.h).
///
/// Text is assumed to come from surveys: z-up.
Result<std::unique_ptr<RowSource>> text_rows(std::span<const std::byte> bytes);

/// True if the lines before the rows and the first row are accepted by text_rows.
bool begins_like_text_table(std::string_view text);

/// The names of the columns in the header of a text that text_rows accepts; none without a header.
std::vector<std::string> text_column_names(std::string_view text);

/// Reads the points of a 3D Tiles tileset (pnts, glTF), depth first, through external tilesets and implicit tilings
/// too. Transforms multiply down the tree. Of tiles that others replace only the deepest are read. No file outside of
/// the tileset's folder and no URL is read; other kinds of content are refused by name.
Result<std::unique_ptr<RowSource>> tileset_rows(const std::filesystem::path& path, const DecodingLimit& limit);

}  // namespace surfcast::scan
