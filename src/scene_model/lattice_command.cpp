#include "scene_model/lattice_command.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "floe/options/options.h"

namespace floe {

std::string command_that_makes(const std::string& file, const std::string& scene_text) {
  std::istringstream lines(scene_text);
  for (std::string line; std::getline(lines, line);) {
    const auto begin = line.find_first_not_of("# \t");
    if (!line.starts_with('#') || begin == std::string::npos) continue;
    line = line.substr(begin, line.find("&&") - begin);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
    std::istringstream words(line);
    std::string first, word;
    words >> first;
    while (words >> word) {
      if (word == file) return line;
    }
  }
  return {};
}

void require_lattice_file(const Scene& scene, MPI_Comm comm) {
  std::string verdict;
  std::error_code error;
  if (rank(comm) == 0 && !std::filesystem::exists(scene.lattice_file, error) && !error) {
    std::ifstream file(scene.path);
    std::ostringstream text;
    text << file.rdbuf();
    const std::string command = command_that_makes(scene.lattice_file, text.str());
    verdict = "lattice_file: '" + scene.lattice_file + "' is not there; " +
              (command.empty() ? "floe make_lattice --help tells how to make one"
                               : "make it with: " + command);
  }
  throw_verdict(std::move(verdict), comm);
}

}  // namespace floe
