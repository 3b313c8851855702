#include "places.h"

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

namespace floe::program {

namespace fs = std::filesystem;

fs::path program_file() {
  // /proc/self/exe would be the loader if that runs the program.
  const auto here = reinterpret_cast<std::uintptr_t>(&program_file);
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    unsigned long long from = 0, to = 0;
    if (std::sscanf(line.c_str(), "%llx-%llx", &from, &to) != 2) continue;
    if (here < from || here >= to) continue;
    const auto path = line.find('/');
    return path == std::string::npos ? fs::path() : fs::path(line.substr(path));
  }
  return {};
}

fs::path share_folder() {
  const fs::path folder = program_file().parent_path();
  if (folder.empty()) return {};
  for (const fs::path& candidate : {folder / FLOE_SHARE_FROM_BIN, folder / "share/floe"}) {
    std::error_code none;
    if (fs::is_directory(candidate / "tools", none)) return candidate.lexically_normal();
  }
  return {};
}

}  // namespace floe::program
