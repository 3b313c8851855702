#include "go_on.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "options/option_names.h"

namespace floe::program {

std::string shell_word(const std::string& word) {
  constexpr std::string_view harmless = "_./:,=+@%-";
  const auto plain = [&](unsigned char c) {
    return std::isalnum(c) != 0 || harmless.find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string command_to_go_on(const Words& words, const std::string& checkpoint, int ranks) {
  std::string line = ranks > 1 ? "mpiexec -n " + std::to_string(ranks) + " " : "";
  line += shell_word(words.at(0));
  std::size_t k = 1;
  if (k < words.size() && !is_option_word(words[k])) line += " " + shell_word(words[k++]);
  line += " -checkpoint_restart " + shell_word(checkpoint);
  while (k < words.size()) {
    const bool goes = words[k] == "-checkpoint_restart" || words[k] == "-output_overwrite";
    do {
      if (!goes) line += " " + shell_word(words[k]);
      ++k;
    } while (k < words.size() && !is_option_word(words[k]));
  }
  return line;
}

}  // namespace floe::program
