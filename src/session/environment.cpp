#include "session/environment.h"

#include <sys/stat.h>

#include <cctype>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include "base/collectives.h"
#include "floe/options/options.h"
#include "options/option_names.h"

namespace floe {
namespace {

constexpr std::size_t largest_file = 1U << 20;

/// Splits at blanks. A word that begins with a quote ends at the next quote of the same kind.
std::vector<std::string> split(std::string_view text) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size();) {
    if (blank(text[at])) {
      ++at;
      continue;
    }
    const bool quoted = text[at] == '"' || text[at] == '\'';
    const char quote = text[at];
    if (quoted) ++at;
    const std::size_t begin = at;
    while (at < text.size() && !(quoted ? text[at] == quote : blank(text[at]))) ++at;
    words.emplace_back(text.substr(begin, at - begin));
    if (quoted) ++at;
  }
  return words;
}

std::string name_of(const std::string& word) { return petsc_name(word.substr(1)); }

/// Returns the text of a file; empty if there is no readable regular file of at most 1 MiB.
std::string text_of(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  if (static_cast<std::size_t>(status.st_size) > largest_file) return {};
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Returns rank 0's text on all ranks. Collective.
std::string shared(std::string text, MPI_Comm comm) {
  broadcast(text, comm);
  return text;
}

void put_over(GivenOptions& options, const GivenOptions& stronger) {
  for (const auto& [name, given] : stronger) options[name] = given;
}

}  // namespace

GivenOptions parse_petscrc(const std::string& text, const std::string& place) {
  GivenOptions options;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::vector<std::string> words = split(line.substr(0, line.find('#')));
    if (words.empty() || !is_option_word(words[0])) continue;
    options[name_of(words[0])] = {words.size() > 1 ? words[1] : "", Source::environment,
                                  place + ", line " + std::to_string(number)};
  }
  return options;
}

GivenOptions parse_petsc_options(const std::string& text, const std::string& place) {
  GivenOptions options;
  const std::vector<std::string> words = split(text);
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (!is_option_word(words[k])) continue;
    const bool has_value = k + 1 < words.size() && !is_option_word(words[k + 1]);
    options[name_of(words[k])] = {has_value ? words[k + 1] : "", Source::environment, place};
  }
  return options;
}

GivenOptions read_environment(bool petscrc, MPI_Comm comm) {
  GivenOptions options;
  if (petscrc) {
    const char* home = std::getenv("HOME");
    const std::string at_home = shared(home ? std::string(home) + "/.petscrc" : "", comm);
    for (const std::string& path : {at_home, std::string(".petscrc"), std::string("petscrc")}) {
      const std::string text = shared(rank(comm) == 0 ? text_of(path) : "", comm);
      put_over(options, parse_petscrc(text, path));
    }
  }
  const char* variable = std::getenv("PETSC_OPTIONS");
  const std::string text = shared(variable ? variable : "", comm);
  put_over(options, parse_petsc_options(text, "PETSC_OPTIONS"));
  return options;
}

}  // namespace floe
