/// \file
/// A table of options and the reader of their values. The table gives the name, type, default,
/// unit, range and documentation of every option; `floe -help`, docs/options.md and all error
/// messages are generated from it. Session puts only the options of PETSc's families into PETSc's
/// own table: that table holds at most 512 options and ignores case, and PETSc's readers accept
/// nan, surplus numbers and trailing words.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"
#include "floe/base/rotation.h"
#include "floe/options/given.h"

namespace floe {

/// The type of an option's value.
enum class Kind {
  flag,      ///< true or false; the bare name means true
  number,    ///< one finite number
  duration,  ///< a wall time: 3h50m, 90s, 01:30:00, or a number of seconds
  integer,   ///< one integer
  numbers,   ///< OptionSpec::count finite numbers
  choice,    ///< one of the words of OptionSpec::allowed
  choices,   ///< some of the words of OptionSpec::allowed, each at most once
  names,     ///< names of sections: letters and digits, each at most once
  text,      ///< any text that is not empty
};

/// One line of the table.
struct OptionSpec {
  /// The key as in YAML: "sheet: length"; "boundary: NAME: fix" for each name of the list
  /// "boundary: names". The option of the command line has "_" instead of ": ".
  std::string_view key;
  Kind kind;
  /// The default as text. Parentheses mark a text that is not a value: "(required)", or the
  /// behaviour without the option.
  std::string_view fallback;
  std::string_view unit;  ///< empty for a pure number and for text
  /// The allowed values. Numbers: a lower and an upper bound, as in ">= 0, <= 1e7" or "> -1, <
  /// 0.5"; words: "one | two | three".
  std::string_view allowed;
  std::string_view doc;
  int count = 1;  ///< number of values, for Kind::numbers
};

/// A key of the scene's file without effect, and the reason.
struct IdleKey {
  std::string label, why;
};

/// The options given to this run, read by the keys of the table. Every error is an InputError of
/// one line that names the key, the value and the allowed values; all ranks hold the same options,
/// so all ranks raise the same error.
///
/// A key without effect is an error if it comes from the command line, or if the command line gives
/// no options. A key of the scene's file that may be without effect only because of the command
/// line is kept in idle() instead.
class Options {
 public:
  /// What becomes of idle keys of the scene's file where there is no command line.
  enum class Idle { refused, kept };

  /// Sorts and checks the names of all given options.
  /// \param table  must outlive this object
  /// \param user  the given options
  /// \throws InputError if an option is neither in the table nor of one of PETSc's families, with
  /// the nearest known name; or if a section NAME is not listed in `names`, or listed without a
  /// section.
  Options(std::span<const OptionSpec> table, const UserOptions& user, Idle idle = Idle::refused);

  /// Whether an option is given. `name` replaces NAME in the key.
  bool given(std::string_view key, std::string_view name = {}) const;
  /// Whether any option of a section ("sheet") is given. An empty section counts as absent.
  bool given_section(std::string_view section) const;
  /// Whether the command line gives an option, or any option of a section.
  bool on_command_line(std::string_view key, std::string_view name = {}) const;
  bool section_on_command_line(std::string_view section) const;
  /// Whether the command line gives any option of floe.
  bool has_command_line() const;
  /// Marks `key` (an option or a whole section) as without effect in this scene. If it is given,
  /// throws InputError "KEY: WHY" or keeps the key in idle().
  void refuse(std::string_view key, std::string_view why);
  /// As refuse(), for one option; `name` replaces NAME in the key.
  void refuse_one(std::string_view key, std::string_view name, std::string_view why);
  /// As refuse(), for a part of the value of an option; the message begins with `label`.
  void refuse_part(std::string_view key, std::string_view name, const std::string& label,
                   const std::string& why);
  /// Resolves two keys that exclude each other. Returns the given one, or nothing if neither is
  /// given. If both are given, returns the key of the stronger source (see Source), and the other
  /// key is idle.
  /// \throws InputError with the text `both` if both are given by the same source
  std::string_view one_of(std::string_view a, std::string_view b, std::string_view name,
                          const std::string& both);

  // Each option is read once, by one of the functions below. If the table has no default,
  // `otherwise` is the default.
  bool flag(std::string_view key, std::string_view name = {});
  double number(std::string_view key, std::string_view name = {},
                std::optional<double> otherwise = {});
  std::int64_t integer(std::string_view key, std::string_view name = {});
  double duration(std::string_view key, std::string_view name = {});  ///< [s]
  std::string text(std::string_view key, std::string_view name = {},
                   const std::optional<std::string>& otherwise = {});
  std::vector<std::string> words(std::string_view key, std::string_view name = {});
  template <std::size_t N>
  std::array<double, N> numbers(std::string_view key, std::string_view name = {}) {
    std::array<double, N> values{};
    read_numbers(key, name, values);
    return values;
  }
  /// Returns an option of three numbers as a vector.
  Vec3<double> vector(std::string_view key, std::string_view name = {}) {
    const auto [x, y, z] = numbers<3>(key, name);
    return {x, y, z};
  }
  /// Returns the enumerator whose number is the position of the chosen word in OptionSpec::allowed.
  template <class Enum>
  Enum choice(std::string_view key, std::string_view name = {}) {
    return static_cast<Enum>(read_choice(key, name));
  }
  /// Returns the names of the parts of a section ("boundary" -> a, b), in the order of its list
  /// `names`.
  const std::vector<std::string>& names(std::string_view section) const;

  /// Refuses the given options that were never read, because they would have no effect.
  void refuse_unread();
  const std::vector<IdleKey>& idle() const { return idle_; }
  /// Returns every option as read so far, and PETSc's options as given, as YAML that repeats the
  /// run.
  std::string yaml() const;

  /// Returns the command-line names of the options that the scene or the command line gives, that
  /// were read, and that have a value.
  std::vector<std::string> read_and_given() const;

  /// Returns the value of an option of PETSc; empty if it has none or is not given.
  std::string petsc(std::string_view name) const;
  /// Removes PETSc's options that begin with `family`, here and in PETSc's table, because nothing
  /// in this run could use them. Options of the environment and of a checkpoint are removed, with
  /// `of_scene` options of the scene too.
  void leave_out(std::string_view family, bool of_scene);
  /// Returns PETSc's options that may stay unused without an error: those of the environment and of
  /// a checkpoint, and those of the scene if the command line gives others.
  std::set<std::string> may_stay_unused() const;
  /// Describes in one line which options of the environment are taken and which are not; empty if
  /// the environment gives none.
  std::string environment_remark() const;

 private:
  struct Reading {
    const OptionSpec& spec;
    std::string option;                     ///< name on the command line
    std::string label;                      ///< key with NAME filled in
    std::optional<std::string> value = {};  ///< as given, else the table's default, else nothing
    std::string place = {};                 ///< " (story.yaml, line 3)", or empty
    bool is_list = false;
  };
  /// A line of the table, and the part of an option that stands for NAME.
  struct Match {
    const OptionSpec* line;
    std::string_view name;
  };
  const OptionSpec& spec(std::string_view key) const;
  const Given* find(std::string_view key, std::string_view name) const;
  Match match(std::string_view option) const;
  Reading read(std::string_view key, std::string_view name);
  void record(const Reading& reading, std::string value);
  void read_numbers(std::string_view key, std::string_view name, std::span<double> values);
  int read_choice(std::string_view key, std::string_view name);
  void read_names();
  void index_table();
  void sort_given(const GivenOptions& all);
  [[noreturn]] void refuse_unknown(const std::string& option, const Given& given) const;
  bool is_section(std::string_view option) const;
  void keep_idle(const std::string& option, const Given& given, const std::string& label,
                 std::string_view why);
  void check_name_of(const std::string& option, const Given& given);
  void check_sections_of_names() const;

  using Lines = std::vector<const OptionSpec*>;

  std::span<const OptionSpec> table_;
  std::map<std::string_view, const OptionSpec*> by_key_;
  std::map<std::string, const OptionSpec*, std::less<>> by_option_;  ///< lines without NAME
  std::map<std::string_view, Lines> by_section_;
  std::map<std::string_view, Lines> named_;  ///< lines with NAME, by section
  bool collect_idle_ = false;
  GivenOptions given_;    ///< options of floe
  GivenOptions petsc_;    ///< options of PETSc
  GivenOptions ignored_;  ///< options of the environment that are not taken
  std::map<std::string, std::vector<std::string>, std::less<>> names_;  ///< by section
  std::map<std::string, std::set<std::string, std::less<>>, std::less<>> known_names_;
  std::map<std::string, std::string, std::less<>> read_;  ///< values as read, by option
  std::set<std::string, std::less<>> idle_options_;
  std::vector<IdleKey> idle_;
};

/// Joins at most six of the items: "a, b and 7 more".
std::string some_of(const std::vector<std::string>& items);

/// Formats a table as text for a terminal, as Markdown, and as part of a man page (groff_man(7)).
std::string help_text(std::span<const OptionSpec> table);
std::string help_markdown(std::span<const OptionSpec> table);
std::string help_man(std::span<const OptionSpec> table);

/// Returns the help of one topic: a section ("sheet"), a family of keys ("obstacle_leg") or a whole
/// key ("sheet_length", "sheet: length"); empty if the topic does not exist.
std::string help_topic(std::span<const OptionSpec> table, std::string_view topic);

}  // namespace floe
