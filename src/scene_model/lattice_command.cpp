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
    line = line.substr(begin);
    if (!line.starts_with("floe ") && !line.starts_with("tools/")) continue;
    // Commands joined by && end with the one that names the file: those after it read the file.
    std::size_t from = 0, end = 0;
    do {
      end = line.find("&&", from);
      std::istringstream words(line.substr(from, end - from));
      for (std::string word; words >> word;) {
        if (word != file) continue;
        line = line.substr(0, end);
        while (line.back() == ' ' || line.back() == '\r') line.pop_back();
        return line;
      }
      from = end + 2;
    } while (end != std::string::npos);
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
