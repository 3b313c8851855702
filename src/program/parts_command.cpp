#include "parts_command.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "floe/base/petsc.h"
#include "floe/solid/solid_file.h"
#include "program.h"
#include "solid/parts_file.h"

namespace floe::program {

int make_parts(int argc, char** argv) {
  if (argc != 7) {
    std::fputs("-make_parts: FILE UNIT TOLERANCE MOST_PARTS OUT.h5\n", stderr);
    return bad_input;
  }
  try {
    const SolidFile solid{argv[2], std::atof(argv[3]), std::atof(argv[4]), std::atoi(argv[5])};
    const ConvexParts parts = parts_of(solid, "argument FILE", parts_folder());
    write_parts(parts, argv[6]);
    std::printf(
        "{\"triangles\": %lld, \"parts\": %d, \"faces\": %zu, \"volume\": %.17g, "
        "\"parts_volume\": %.17g, \"distance\": %.17g}\n",
        static_cast<long long>(parts.triangles), static_cast<int>(parts.shapes.bodies()),
        parts.shapes.corner_of.size() - 1, parts.volume, parts.parts_volume, parts.distance);
    return done;
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return bad_input;
  } catch (const FileError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return failed;
  }
}

}  // namespace floe::program
