// Writes a textured mesh of the laboratory: make_mesh NAME FOLDER.
#include <cstdio>

#include "lab/mesh_scenes.h"

int main(int argc, char** argv) {
  if (argc == 3 && surfcast::lab::write_mesh_scene(argv[1], argv[2])) return 0;
  std::fputs("usage: make_mesh NAME FOLDER, with a name of:", stderr);
  for (const std::string& name : surfcast::lab::mesh_scene_names()) std::fprintf(stderr, " %s", name.c_str());
  std::fputs("\n", stderr);
  return 2;
}
