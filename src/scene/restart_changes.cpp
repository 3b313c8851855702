#include "restart_changes.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>

#include "floe/scene/keys.h"
#include "options/option_names.h"
#include "options/option_values.h"

namespace floe {
namespace {

/// Sections and keys that may change. Of the options that move bodies only loads may: they jump at
/// the time of the checkpoint. The places of obstacles and boundaries are functions of the time
/// since 0, so they would jump together with everything in contact with them.
constexpr std::array<std::string_view, 14> may_change{
    "time: end",
    "time: allow_unstable",
    "limit",
    "output",
    "partition",
    "checkpoint",
    "report",
    "check",
    "sheet: mesh_file",
    "backend",
    "lattice_file",  // its contents may not change
    "load: NAME: force",
    "load: NAME: moment",
    "load: NAME: ramp"};

/// What must stay in sections that may change: /obstacles of lattice.h5 has the patches.
constexpr std::string_view stays = "output: pressure_patch";

bool is_free(std::string_view key) {
  if (key == stays) return false;
  const auto is_it = [&](std::string_view free) { return free == key || free == section_of(key); };
  return std::any_of(may_change.begin(), may_change.end(), is_it);
}

/// The table's line of an option of the command line, and the option's name in messages.
struct Known {
  const OptionSpec* line = nullptr;
  std::string label;
};

Known known(std::string_view option) {
  for (const OptionSpec& line : scene_keys()) {
    if (!has_name(line.key)) {
      if (option_name(line.key) == option) return {&line, std::string(line.key)};
      continue;
    }
    const std::string front = std::string(section_of(line.key)) + "_",
                      back = "_" + std::string(last_word(line.key));
    if (!option.starts_with(front) || !option.ends_with(back) ||
        option.size() <= front.size() + back.size())
      continue;
    const auto name = option.substr(front.size(), option.size() - front.size() - back.size());
    if (is_name(name)) return {&line, option_label(line.key, name)};
  }
  return {};
}

bool same_item(const std::string& a, const std::string& b) {
  const auto x = to_number(a), y = to_number(b);
  return x && y ? *x == *y : a == b;
}

/// Whether two texts have the same value.
bool is_same(Kind kind, const std::string& a, const std::string& b) {
  if (a == b) return true;
  if (kind == Kind::flag) return to_flag(a) && to_flag(a) == to_flag(b);
  if (kind == Kind::choice && to_flag(a) && !a.empty()) return to_flag(a) == to_flag(b);
  if (kind == Kind::text) return false;
  const auto x = to_list(a), y = to_list(b);
  if (!x || !y || x->size() != y->size()) return false;
  if (kind == Kind::choices)
    return std::set(x->begin(), x->end()) == std::set(y->begin(), y->end());
  return std::equal(x->begin(), x->end(), y->begin(), same_item);
}

std::string list(const std::string& value) {
  std::string text;
  for (const char c : value) text += c == ',' ? std::string(", ") : std::string(1, c);
  return text;
}

[[noreturn]] void refuse(const std::string& label, const Given& given, const std::string& before) {
  throw InputError(label + ": " + shown(list(given.value)) +
                   " cannot be changed where a run goes on; the checkpoint has " +
                   (before.empty() ? "none" : shown(list(before))) +
                   (given.place.empty() ? "" : " (" + given.place + ")"));
}

}  // namespace

void refuse_changes(const UserOptions& user) {
  if (user.checkpoint.empty()) return;
  for (const GivenOptions* options : {&user.command_line, &user.scene}) {
    for (const auto& [option, given] : *options) {
      if (options == &user.scene && user.command_line.contains(option)) continue;
      const auto before = user.checkpoint.find(option);
      const std::string was = before == user.checkpoint.end() ? "" : before->second.value;
      // PETSc's options are tuning, except the step; the run checks the type of its stepper itself.
      if (option == "ts_dt" && !same_item(given.value, was)) refuse(option, given, was);
      const auto [line, label] = known(option);
      if (line == nullptr || is_free(line->key) || before == user.checkpoint.end()) continue;
      if (!is_same(line->kind, given.value, was)) refuse(label, given, was);
    }
  }
}

void refuse_additions(const Options& options, const UserOptions& user) {
  if (user.checkpoint.empty()) return;
  for (const std::string& option : options.read_and_given()) {
    const auto [line, label] = known(option);
    if (line == nullptr || is_free(line->key) || user.checkpoint.contains(option)) continue;
    const bool commanded = user.command_line.contains(option);
    refuse(label, (commanded ? user.command_line : user.scene).at(option), "");
  }
}

bool is_taken_along(std::string_view option) {
  if (!is_petsc_option(option)) return true;
  constexpr std::array<std::string_view, 5> solvers{"ts_", "snes_", "ksp_", "pc_", "mat_"};
  constexpr std::array<std::string_view, 5> watching{"monitor", "view", "reason", "ts_max_steps",
                                                     "ts_max_time"};
  const auto is_in = [&](std::string_view part) {
    return option.find(part) != std::string_view::npos;
  };
  // Inner solvers have these families after a prefix of their own: sub_pc_type.
  return std::any_of(solvers.begin(), solvers.end(), is_in) &&
         std::none_of(watching.begin(), watching.end(), is_in);
}

}  // namespace floe
