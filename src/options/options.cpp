// The assignment of given options to the lines of the table, and the check that they have an
// effect.
#include "floe/options/options.h"
#include "base/collectives.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "options/option_names.h"
#include "options/option_values.h"

namespace floe {

GivenOptions UserOptions::merged() const {
  GivenOptions all = environment;
  for (const GivenOptions* stronger : {&checkpoint, &scene, &command_line}) {
    for (const auto& [name, given] : *stronger) all[name] = given;
  }
  return all;
}

Options::Options(std::span<const OptionSpec> table, const UserOptions& user, Idle idle)
    : table_(table), collect_idle_(idle == Idle::kept) {
  index_table();
  sort_given(user.merged());
  collect_idle_ = collect_idle_ || has_command_line();
  read_names();
  for (const auto& [name, given] : given_) check_name_of(name, given);
  check_sections_of_names();
}

void Options::index_table() {
  for (const OptionSpec& line : table_) {
    by_key_[line.key] = &line;
    by_section_[section_of(line.key)].push_back(&line);
    if (has_name(line.key)) {
      named_[section_of(line.key)].push_back(&line);
    } else {
      by_option_[option_name(line.key)] = &line;
    }
  }
}

namespace {

/// Returns the section and the name in an option that would be one of a named section if the name
/// were one: "obstacle", "my_leg" of obstacle_my_leg_centre; else nothing.
/// \param named  lines with NAME, by section
template <class Named>
std::pair<std::string, std::string> ill_named(const Named& named, std::string_view option) {
  const auto first = option.find('_');
  if (first == std::string_view::npos) return {};
  const auto lines = named.find(option.substr(0, first));
  if (lines == named.end()) return {};
  const std::string_view rest = option.substr(first + 1);
  std::string_view name;
  for (const OptionSpec* line : lines->second) {
    const std::string word = "_" + std::string(last_word(line->key));
    if (!rest.ends_with(word)) continue;
    const std::string_view before = rest.substr(0, rest.size() - word.size());
    if (name.empty() || before.size() < name.size()) name = before;  // by the longest key
  }
  if (name.empty() || is_name(name)) return {};
  return {std::string(lines->first), std::string(name)};
}

}  // namespace

/// Returns the line of the table to which an option belongs; null if there is none.
Options::Match Options::match(std::string_view option) const {
  if (const auto plain = by_option_.find(option); plain != by_option_.end())
    return {plain->second, {}};
  const auto first = option.find('_');
  const auto second = first == std::string_view::npos ? first : option.find('_', first + 1);
  if (second == std::string_view::npos) return {};
  const auto lines = named_.find(option.substr(0, first));
  const std::string_view name = option.substr(first + 1, second - first - 1);
  if (lines == named_.end() || !is_name(name)) return {};
  const std::string_view word = option.substr(second + 1);
  for (const OptionSpec* line : lines->second) {
    if (last_word(line->key) == word) return {line, name};
  }
  return {};
}

/// Puts options of floe into given_ and options of PETSc into petsc_. An unknown name without a
/// value may be an empty section.
void Options::sort_given(const GivenOptions& all) {
  for (const auto& [name, given] : all) {
    if (given.source == Source::environment) {
      (is_environment_option(name) ? petsc_ : ignored_)[name] = given;
    } else if (match(name).line != nullptr) {
      given_[name] = given;
    } else if (is_section(name)) {
      if (!given.value.empty())
        throw InputError(name + ": is a section of options, not one with a value (" +
                         shown(given.value) + ")" + in_brackets(given.place));
    } else if (is_petsc_option(name)) {
      petsc_[name] = given;
    } else {
      refuse_unknown(name, given);
    }
  }
}

void Options::refuse_unknown(const std::string& option, const Given& given) const {
  if (const auto [section, name] = ill_named(named_, option); !name.empty())
    throw InputError(section + ": names: '" + name +
                     "' is no name: a name has letters and digits, at most 40" +
                     in_brackets(given.place));
  const std::string small = lower(option);
  std::string hint;
  if (small != option && (match(small).line != nullptr || is_section(small))) {
    hint = "; keys are in lower case: '" + small + "'";
  } else if (const std::string near = nearest_option(option, table_); !near.empty()) {
    hint = "; the nearest known one is '" + near + "'";
  }
  throw InputError(option + ": unknown option" + hint + " (floe -help lists them)" +
                   in_brackets(given.place));
}

/// Whether a name is that of a section: "sheet", "boundary", "boundary_a".
bool Options::is_section(std::string_view option) const {
  const auto cut = option.find('_');
  const std::string_view section = option.substr(0, cut);
  if (section.empty() || !by_section_.contains(section)) return false;
  return cut == std::string_view::npos ||
         (named_.contains(section) && is_name(option.substr(cut + 1)));
}

void Options::read_names() {
  for (const OptionSpec& line : table_) {
    if (line.kind != Kind::names) continue;
    const Reading reading = read(line.key, {});
    const std::string value = reading.value.value_or("");
    const auto list = to_list(value);
    std::set<std::string> small;  // two names that differ only in case would be confused
    for (const std::string& name : list.value_or(std::vector<std::string>{}))
      small.insert(lower(name));
    const bool distinct = list && small.size() == list->size();
    if (!distinct || !std::all_of(list->begin(), list->end(), is_name))
      refuse_value(line, reading.label, value, reading.place);
    if (!list->empty()) record(reading, value);
    const std::string section(section_of(line.key));
    known_names_[section] = {list->begin(), list->end()};
    names_[section] = *list;
  }
}

/// Checks that an option of a named section belongs to a listed name.
void Options::check_name_of(const std::string& option, const Given& given) {
  const auto [line, name] = match(option);
  if (name.empty()) return;
  const std::string section(section_of(line->key));
  if (known_names_.at(section).contains(name)) return;
  const std::string label = section + ": " + std::string(name);
  if (!idle_.empty() && idle_.back().label == label) {
    idle_options_.insert(option);  // one message per name is enough
    return;
  }
  keep_idle(option, given, label,
            "is not listed in '" + section + ": names', so it would have no effect");
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
  const auto line = by_key_.find(key);
  if (line == by_key_.end())
    throw std::logic_error("not in the table of options: " + std::string(key));
  return *line->second;
}

const Given* Options::find(std::string_view key, std::string_view name) const {
  const auto found = given_.find(option_name(spec(key).key, name));
  return found == given_.end() ? nullptr : &found->second;
}

bool Options::given(std::string_view key, std::string_view name) const {
  return find(key, name) != nullptr;
}

bool Options::on_command_line(std::string_view key, std::string_view name) const {
  const Given* found = find(key, name);
  return found != nullptr && found->source == Source::command_line;
}

bool Options::has_command_line() const {
  return std::any_of(given_.begin(), given_.end(),
                     [](const auto& entry) { return entry.second.source == Source::command_line; });
}

bool Options::given_section(std::string_view section) const {
  for (const OptionSpec* line : by_section_.at(section)) {
    if (has_name(line->key) ? !names(section).empty() : given(line->key)) return true;
  }
  return false;
}

bool Options::section_on_command_line(std::string_view section) const {
  for (const OptionSpec* line : by_section_.at(section)) {
    if (!has_name(line->key) && on_command_line(line->key)) return true;
  }
  if (!named_.contains(section)) return false;
  const std::string front = std::string(section) + "_";
  for (auto at = given_.lower_bound(front); at != given_.end() && at->first.starts_with(front);
       ++at) {
    if (at->second.source == Source::command_line) return true;
  }
  return false;
}

void Options::keep_idle(const std::string& option, const Given& given, const std::string& label,
                        std::string_view why) {
  if (given.source == Source::command_line || !collect_idle_)
    throw InputError(label + ": " + std::string(why) + in_brackets(given.place));
  if (idle_options_.insert(option).second) idle_.push_back({label, std::string(why)});
}

void Options::refuse_one(std::string_view key, std::string_view name, std::string_view why) {
  if (const Given* found = find(key, name))
    keep_idle(option_name(key, name), *found, option_label(key, name), why);
}

void Options::refuse_part(std::string_view key, std::string_view name, const std::string& label,
                          const std::string& why) {
  const Given* found = find(key, name);
  const bool of_scene = found != nullptr && found->source != Source::command_line;
  if (!of_scene || !collect_idle_) throw InputError(label + ": " + why);
  idle_.push_back({label, why});
}

void Options::refuse(std::string_view key, std::string_view why) {
  if (by_key_.contains(key)) return refuse_one(key, {}, why);
  for (const OptionSpec* line : by_section_.at(key)) {
    if (!has_name(line->key)) refuse_one(line->key, {}, why);
  }
  if (!named_.contains(key)) return;
  // Of a section with names, idle() lists only the key "obstacle: names", not the options of each
  // name.
  const std::string front = std::string(key) + "_";
  for (auto at = given_.lower_bound(front); at != given_.end() && at->first.starts_with(front);
       ++at) {
    const auto [line, name] = match(at->first);
    if (name.empty()) continue;
    if (at->second.source == Source::command_line)
      keep_idle(at->first, at->second, option_label(line->key, name), why);
    idle_options_.insert(at->first);
  }
}

std::string_view Options::one_of(std::string_view a, std::string_view b, std::string_view name,
                                 const std::string& both) {
  const Given *one = find(a, name), *other = find(b, name);
  if (one == nullptr || other == nullptr) return one ? a : other ? b : std::string_view();
  if (one->source == other->source) throw InputError(both);
  const bool first_wins = one->source > other->source;
  const std::string_view winner = first_wins ? a : b, loser = first_wins ? b : a;
  const bool said_last = (first_wins ? one : other)->source == Source::command_line;
  refuse_one(loser, name,
             "'" + option_label(winner, name) + "' of the " +
                 (said_last ? "command line" : "scene") + " takes its place");
  return winner;
}

const std::vector<std::string>& Options::names(std::string_view section) const {
  const auto found = names_.find(section);
  if (found == names_.end())
    throw std::logic_error("no section with names: " + std::string(section));
  return found->second;
}
void Options::refuse_unread() {
  for (const auto& [option, given] : given_) {
    if (read_.contains(option) || idle_options_.contains(option)) continue;
    const auto [line, name] = match(option);
    if (line != nullptr)  // all that were given are in the table
      keep_idle(option, given, option_label(line->key, name), "would have no effect in this scene");
  }
}
std::vector<std::string> Options::read_and_given() const {
  std::vector<std::string> names;
  for (const auto& [option, given] : given_) {
    const auto found = read_.find(option);
    const bool is_new = given.source == Source::scene || given.source == Source::command_line;
    if (is_new && found != read_.end() && !found->second.empty()) names.push_back(option);
  }
  return names;
}

std::string some_of(const std::vector<std::string>& items) {
  constexpr std::size_t most = 6;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, items.size()); ++k) text += (k ? ", " : "") + items[k];
  if (items.size() > most) text += " and " + std::to_string(items.size() - most) + " more";
  return text;
}
}  // namespace floe
