#include "session/blame.h"

#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/options/options.h"
#include "options/option_values.h"

namespace floe {
namespace {

/// One object per process, like PETSc's table of options.
struct Suspects {
  bool good = true;
  GivenOptions given;
  std::string crash;
};
Suspects& suspects() {
  static Suspects all;
  return all;
}

/// Whether `part` occurs in a text as a whole word.
bool has_word(std::string_view text, std::string_view part) {
  const auto ends = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-';
  };
  for (auto at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) {
    const auto after = at + part.size();
    if ((at == 0 || ends(text[at - 1])) && (after == text.size() || ends(text[after]))) return true;
  }
  return false;
}

std::string as_given(const GivenOptions::value_type& option) {
  const auto& [name, given] = option;
  return name + (given.value.empty() ? "" : " " + shown(given.value)) + in_brackets(given.place);
}

/// Returns the options whose names occur in a text; if there are none, those whose values occur.
std::vector<std::string> named_in(const std::string& text) {
  std::vector<std::string> names, values;
  for (const auto& option : suspects().given) {
    const auto& [name, given] = option;
    if (has_word(text, name) || has_word(text, "-" + name)) names.push_back(as_given(option));
    if (!given.value.empty() && has_word(text, given.value)) values.push_back(as_given(option));
  }
  return names.empty() ? values : names;
}

std::vector<std::string> all_given() {
  std::vector<std::string> all;
  for (const auto& option : suspects().given) all.push_back(as_given(option));
  return all;
}

std::string one_of(const std::vector<std::string>& options) {
  return options.size() == 1 ? options.front()
                             : "one of the solver's options (" + some_of(options) + ")";
}

}  // namespace

void set_solver_options(GivenOptions given) {
  Suspects& me = suspects();
  me.good = given.empty();
  me.given = std::move(given);
  me.crash = me.good ? "" : one_of(all_given()) + ": PETSc cannot take it: it crashed";
}

void solver_options_are_good() { suspects().good = true; }

bool solver_options_are_doubtful() { return !suspects().good; }

std::string blame_solver_options(const std::string& petsc_says) {
  const auto named = named_in(petsc_says);
  return one_of(named.empty() ? all_given() : named) + ": PETSc cannot take it: " + petsc_says;
}

std::string solver_option_named(const std::string& petsc_says) {
  const auto named = named_in(petsc_says);
  return named.empty() ? "" : "-" + named.front();
}

const char* blame_for_a_crash() { return suspects().good ? "" : suspects().crash.c_str(); }

}  // namespace floe
