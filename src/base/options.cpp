#include "floe/base/options.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <set>
#include <sstream>
#include <stdexcept>

#include "option_names.h"
#include "option_values.h"

namespace floe {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

/// Options that nothing has asked for so far, without their dash.
Pairs unused_options() {
  PetscInt n = 0;
  char **names = nullptr, **values = nullptr;
  check(PetscOptionsLeftGet(nullptr, &n, &names, &values));
  Pairs options;
  for (PetscInt k = 0; k < n; ++k) options.emplace_back(names[k], values[k] ? values[k] : "");
  check(PetscOptionsLeftRestore(nullptr, &n, &names, &values));
  return options;
}

std::string find_value(const std::string& option) {
  const char* value = nullptr;
  PetscBool found = PETSC_FALSE;
  check(PetscOptionsFindPair(nullptr, nullptr, ("-" + option).c_str(), &value, &found));
  return value ? value : "";
}

/// Options that PetscInitialize has used already (log_view and the like). PETSc gives them only as
/// one line of text; a word counts as an option if PETSc knows it as a used one.
Pairs used_options() {
  char* all = nullptr;
  check(PetscOptionsGetAll(nullptr, &all));
  const std::string line(all);
  check(PetscFree(all));
  Pairs options;
  std::istringstream words(line);
  for (std::string word; words >> word;) {
    if (word.size() < 2 || word[0] != '-') continue;
    const std::string name = word.substr(1);
    PetscBool used = PETSC_FALSE;
    check(PetscOptionsUsed(nullptr, name.c_str(), &used));
    if (used) options.emplace_back(name, find_value(name));
  }
  return options;
}

/// Whether `option` is this line's, for some NAME if it has one.
bool is_option_of(const OptionSpec& line, std::string_view option) {
  if (!has_name(line.key)) return option == option_name(line.key);
  const std::string front = std::string(section_of(line.key)) + "_";
  const std::string back = "_" + std::string(last_word(line.key));
  return option.size() > front.size() + back.size() && option.starts_with(front) &&
         option.ends_with(back) &&
         is_name(option.substr(front.size(), option.size() - front.size() - back.size()));
}

bool is_value(std::string_view fallback) { return !fallback.empty() && fallback.front() != '('; }

/// What PETSc asks for only while it ends.
bool is_asked_for_at_the_end(std::string_view name) {
  constexpr std::array late{"citations", "get_total_flops", "mpidump", "objects_dump",
                            "stack_view"};
  return std::find(late.begin(), late.end(), name) != late.end() || name.starts_with("options_") ||
         name.starts_with("malloc_");
}

/// Viewers may be asked for at any time.
bool is_viewer(std::string_view name) {
  return name.find("_view") != std::string_view::npos || name.starts_with("viewer_");
}

[[noreturn]] void refuse_value(const OptionSpec& spec, const std::string& label,
                               std::string_view value) {
  throw InputError(label + ": " + (value.empty() ? "no value given," : shown(value)) + " must be " +
                   allowed_text(spec));
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), end);
}

}  // namespace

Options::Options(std::span<const OptionSpec> table) : table_(table) {
  Pairs database = used_options();
  const Pairs unused = unused_options();
  database.insert(database.end(), unused.begin(), unused.end());
  sort_given(database);
  read_names();
  for (const auto& [name, value] : given_) check_name_of(name);
  check_sections_of_names();
}

/// Ours into given_, PETSc's into petsc_. What is neither and has no value may be an empty section.
void Options::sort_given(const Pairs& database) {
  for (const auto& [name, value] : database) {
    const bool ours = std::any_of(
        table_.begin(), table_.end(),
        [&option = name](const OptionSpec& line) { return is_option_of(line, option); });
    if (ours) {
      given_[name] = value;
    } else if (is_section(name)) {
      if (!value.empty() && value != "~" && value != "null")
        throw InputError(name + ": is a section of options, not one with a value (" + shown(value) +
                         ")");
      find_value(name);  // marks it as used
    } else if (is_petsc_option(name)) {
      petsc_.emplace_back(name, value);
    } else {
      const std::string near = nearest_option(name, table_);
      throw InputError(name + ": unknown option" +
                       (near.empty() ? "" : "; the nearest known one is '" + near + "'") +
                       " (floe -help lists them)");
    }
  }
}

/// "sheet", "boundary", "boundary_a".
bool Options::is_section(std::string_view option) const {
  return std::any_of(table_.begin(), table_.end(), [&](const OptionSpec& line) {
    const std::string_view section = section_of(line.key);
    if (section.empty()) return false;
    if (option == section) return true;
    return has_name(line.key) && option.starts_with(std::string(section) + "_") &&
           is_name(option.substr(section.size() + 1));
  });
}

void Options::read_names() {
  for (const OptionSpec& line : table_) {
    if (line.kind != Kind::names) continue;
    const Reading reading = read(line.key, {});
    const std::string value = reading.value.value_or("");
    const auto list = to_list(value);
    const bool distinct = list && std::set(list->begin(), list->end()).size() == list->size();
    if (!distinct || !std::all_of(list->begin(), list->end(), is_name))
      refuse_value(line, reading.label, value);
    if (!list->empty()) record(reading, value);
    names_[std::string(section_of(line.key))] = *list;
  }
}

/// An option of a named section must belong to a listed name.
void Options::check_name_of(std::string_view option) const {
  const auto line = std::find_if(table_.begin(), table_.end(), [&](const OptionSpec& candidate) {
    return has_name(candidate.key) && is_option_of(candidate, option);
  });
  if (line == table_.end()) return;
  const std::string section(section_of(line->key));
  const std::string_view rest = option.substr(section.size() + 1);
  const std::string name(rest.substr(0, rest.find('_')));
  const auto& known = names(section);
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw InputError(section + ": " + name + ": is not listed in '" + section +
                     ": names', so it would have no effect");
}

void Options::check_sections_of_names() const {
  for (const auto& [section, list] : names_) {
    for (const std::string& name : list) {
      const std::string front = section + "_" + name + "_";
      const auto first = given_.lower_bound(front);
      if (first == given_.end() || !first->first.starts_with(front))
        throw InputError(section + ": " + name + ": is listed in '" + section +
                         ": names', but there is no such section");
    }
  }
}

const OptionSpec& Options::spec(std::string_view key) const {
  const auto line = std::find_if(table_.begin(), table_.end(),
                                 [&](const OptionSpec& candidate) { return candidate.key == key; });
  if (line == table_.end())
    throw std::logic_error("not in the table of options: " + std::string(key));
  return *line;
}

bool Options::given(std::string_view key, std::string_view name) const {
  return given_.contains(option_name(spec(key).key, name));
}

bool Options::given_section(std::string_view section) const {
  return std::any_of(table_.begin(), table_.end(), [&](const OptionSpec& line) {
    if (section_of(line.key) != section) return false;
    return has_name(line.key) ? !names(section).empty() : given_.contains(option_name(line.key));
  });
}

void Options::refuse(std::string_view key, std::string_view why) const {
  for (const OptionSpec& line : table_) {
    if (line.key != key && section_of(line.key) != key) continue;
    if (!has_name(line.key) && given(line.key))
      throw InputError(std::string(line.key) + ": " + std::string(why));
  }
}

const std::vector<std::string>& Options::names(std::string_view section) const {
  const auto found = names_.find(section);
  if (found == names_.end())
    throw std::logic_error("no section with names: " + std::string(section));
  return found->second;
}

Options::Reading Options::read(std::string_view key, std::string_view name) {
  const OptionSpec& line = spec(key);
  const std::string option = option_name(key, name);
  if (!read_.try_emplace(option).second) throw std::logic_error("option read twice: " + option);
  Reading reading{line, option_label(key, name), {}};
  if (const auto found = given_.find(option); found != given_.end()) {
    reading.value = find_value(option);
  } else if (is_value(line.fallback)) {
    reading.value = std::string(line.fallback);
  } else if (line.fallback == "(required)") {
    throw InputError(reading.label + ": is missing; it must be " + allowed_text(line));
  }
  return reading;
}

void Options::record(const Reading& reading, std::string value) {
  std::string option = reading.label;
  read_[option_name(option)] = std::move(value);
}

bool Options::flag(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const auto value = to_flag(reading.value.value_or("false"));
  if (!value) refuse_value(reading.spec, reading.label, *reading.value);
  record(reading, *value ? "true" : "false");
  return *value;
}

constexpr std::string_view automatic =
    "(auto)";  // default of numbers that the word auto stands for

double Options::number(std::string_view key, std::string_view name,
                       std::optional<double> otherwise) {
  const Reading reading = read(key, name);
  if (otherwise && reading.spec.fallback == automatic && reading.value == "auto") {
    record(reading, "auto");
    return *otherwise;
  }
  if (!reading.value && otherwise) {
    record(reading, reading.spec.fallback == automatic ? "auto" : shortest(*otherwise));
    return *otherwise;
  }
  const std::string text = reading.value.value_or("");
  const auto value = to_number(text);
  if (!value || !in_range(*value, reading.spec.allowed))
    refuse_value(reading.spec, reading.label, text);
  record(reading, text);
  return *value;
}

std::int64_t Options::integer(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  const auto value = to_integer(text);
  if (!value || !in_range(static_cast<double>(*value), reading.spec.allowed))
    refuse_value(reading.spec, reading.label, text);
  record(reading, text);
  return *value;
}

std::string Options::text(std::string_view key, std::string_view name,
                          const std::optional<std::string>& otherwise) {
  const Reading reading = read(key, name);
  std::string value = reading.value ? *reading.value : otherwise.value_or("");
  if (value.empty()) refuse_value(reading.spec, reading.label, value);
  record(reading, value);
  return value;
}

std::vector<std::string> Options::words(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  auto list = to_list(text);
  const auto known = choices_of(reading.spec.allowed);
  const bool fits = list && std::set(list->begin(), list->end()).size() == list->size() &&
                    std::all_of(list->begin(), list->end(), [&](const std::string& word) {
                      return std::find(known.begin(), known.end(), word) != known.end();
                    });
  if (!fits) refuse_value(reading.spec, reading.label, text);
  if (!list->empty()) record(reading, text);
  return *list;
}

void Options::read_numbers(std::string_view key, std::string_view name, std::span<double> values) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  const auto list = to_list(text);
  if (!list || list->size() != values.size()) refuse_value(reading.spec, reading.label, text);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto value = to_number((*list)[k]);
    if (!value || !in_range(*value, reading.spec.allowed))
      refuse_value(reading.spec, reading.label, text);
    values[k] = *value;
  }
  record(reading, text);
}

int Options::read_choice(std::string_view key, std::string_view name) {
  const Reading reading = read(key, name);
  const std::string text = reading.value.value_or("");
  const auto known = choices_of(reading.spec.allowed);
  const auto chosen = std::find(known.begin(), known.end(), text);
  if (chosen == known.end()) refuse_value(reading.spec, reading.label, text);
  record(reading, text);
  return static_cast<int>(chosen - known.begin());
}

void Options::reject_unread() const {
  for (const OptionSpec& line : table_) {
    const auto reject = [&](std::string_view name) {
      if (given(line.key, name) && !read_.contains(option_name(line.key, name)))
        throw InputError(option_label(line.key, name) + ": would have no effect in this scene");
    };
    if (!has_name(line.key)) {
      reject({});
    } else {
      for (const std::string& name : names(section_of(line.key))) reject(name);
    }
  }
}

void throw_verdict(std::string verdict, MPI_Comm comm) {
  auto length = static_cast<int>(verdict.size());
  MPI_Bcast(&length, 1, MPI_INT, 0, comm);
  verdict.resize(static_cast<std::size_t>(length));
  MPI_Bcast(verdict.data(), length, MPI_CHAR, 0, comm);
  if (!verdict.empty()) throw InputError(verdict);
}

void reject_unused_options() {
  std::string verdict;
  for (const auto& [name, value] : unused_options()) {
    if (is_viewer(name) || is_asked_for_at_the_end(name)) continue;
    const std::string near = nearest_petsc_option(name);
    verdict = name + ": nothing in this run has asked for this PETSc option" +
              (near.empty() ? "" : "; is it '" + near + "'?");
    break;
  }
  throw_verdict(verdict, PETSC_COMM_WORLD);  // a rank may have asked for less than rank 0
}

void warn_unused_options() {
  if (rank() != 0) return;
  for (const auto& [name, value] : unused_options()) {
    if (is_asked_for_at_the_end(name)) continue;
    std::fprintf(stderr, "floe: warning: %s: nothing in this run has asked for this option\n",
                 name.c_str());
  }
}

}  // namespace floe
