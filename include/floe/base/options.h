/// \file
/// A table of options and the one reader of their values. The table gives every option's name,
/// type, default, unit, range and doc; `floe -help`, docs/options.md and all error messages come
/// from it. Only options of PETSc's families are put into PETSc's own table (by Session): that one
/// has room for 512, knows no upper case, and its readers accept nan, too many numbers and trailing
/// words.
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

#include "floe/base/given.h"
#include "floe/base/petsc.h"

namespace floe {

/// What an option's text must be.
enum class Kind {
  flag,      ///< true or false; the bare word is true
  number,    ///< one finite number
  duration,  ///< a time by the clock: 3h50m, 90s, 01:30:00, or a number of seconds
  integer,   ///< one integer
  numbers,   ///< OptionSpec::count finite numbers
  choice,    ///< one of the words of OptionSpec::allowed
  choices,   ///< some of these words, none twice
  names,     ///< names of sections: letters and digits, none twice
  text,      ///< anything that is not empty
};

/// One line of the table.
struct OptionSpec {
  /// As in YAML: "sheet: length"; "boundary: NAME: fix" for each name of the list "boundary:
  /// names". With "_" instead of ": " it is the option of the command line.
  std::string_view key;
  Kind kind;
  /// Default as text; in parentheses if it is no value: "(required)", or what happens without the
  /// option.
  std::string_view fallback;
  std::string_view unit;  ///< empty: a pure number, or no number
  /// Numbers: a lower and an upper bound, as in ">= 0, <= 1e7" or "> -1, < 0.5"; words: "one | two
  /// | three".
  std::string_view allowed;
  std::string_view doc;
  int count = 1;  ///< of Kind::numbers
};

/// A key of the scene's file that has no effect, and why.
struct IdleKey {
  std::string label, why;
};

/// The options given to this run, read by the keys of the table. Every error is an InputError of
/// one line that names key, value and what is allowed; all ranks hold the same options, so all
/// ranks raise it.
///
/// A key without effect is an error if it is of the command line, or if nothing else is. One of the
/// scene's file that may be idle only because of the command line is kept in idle() instead.
class Options {
 public:
  /// Looks at everything that was given. \param collect_idle  keep every idle key of the scene's
  /// file, whether or not there is a command line
  /// \throws InputError if an option is neither in the table nor of one of PETSc's families, with
  /// the nearest known name; or if a section NAME is not listed in `names`, or listed without a
  /// section.
  Options(std::span<const OptionSpec> table, const UserOptions& user, bool collect_idle = false);

  /// Whether an option has been given. `name` stands for NAME in the key.
  bool given(std::string_view key, std::string_view name = {}) const;
  /// Whether any option of a section ("sheet") has been given; empty sections count as absent.
  bool given_section(std::string_view section) const;
  /// Whether it has been given on the command line, or anything of the section has.
  bool on_command_line(std::string_view key, std::string_view name = {}) const;
  bool section_on_command_line(std::string_view section) const;
  /// Whether the command line gives any option of floe's.
  bool has_command_line() const;
  /// `key` (an option or a whole section) has no effect: if it has been given, throws "KEY: WHY" or
  /// keeps it in idle().
  void refuse(std::string_view key, std::string_view why);
  /// The same for one option, which has been given.
  void refuse_one(std::string_view key, std::string_view name, std::string_view why);
  /// The same for a part of the value of an option, which is `label` in the message.
  void refuse_part(std::string_view key, std::string_view name, const std::string& label,
                   const std::string& why);
  /// Of two keys that exclude each other, the one that has been given, or nothing if neither has.
  /// If both have, the one of the stronger source (see Source; the other is then idle), and if both
  /// are from one, throws `both`.
  std::string_view one_of(std::string_view a, std::string_view b, std::string_view name,
                          const std::string& both);

  // Each option is read once, by one of these. Without a value in the table `otherwise` is taken.
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
  /// The enumerator at the chosen word's place in OptionSpec::allowed.
  template <class Enum>
  Enum choice(std::string_view key, std::string_view name = {}) {
    return static_cast<Enum>(read_choice(key, name));
  }
  /// The names of a section's parts ("boundary" -> a, b), in the order of its list `names`.
  const std::vector<std::string>& names(std::string_view section) const;

  /// Refuses the options that have been given but were not read: they would have no effect.
  void refuse_unread();
  const std::vector<IdleKey>& idle() const { return idle_; }
  /// Every option as read so far, and PETSc's as given, as YAML that repeats the run.
  std::string yaml() const;

  /// Of the options that the scene or the command line gives, those that have been read and have a
  /// value, by their names on the command line.
  std::vector<std::string> read_and_given() const;

  /// Value of an option of PETSc's; empty if it has none or is not given.
  std::string petsc(std::string_view name) const;
  /// Takes PETSc's options that begin with `family` out, here and in PETSc's table, if they are of
  /// the environment (or of the scene, with `of_scene`): nothing in this run could ask for them.
  void leave_out(std::string_view family, bool of_scene);
  /// PETSc's options that may well stay unused: those of the environment, and those of the scene if
  /// the command line gives others.
  std::set<std::string> may_stay_unused() const;
  /// What has been taken from the environment and what not, in one line; empty if it gives nothing.
  std::string environment_remark() const;

 private:
  struct Reading {
    const OptionSpec& spec;
    std::string option;                ///< its name on the command line
    std::string label;                 ///< key with NAME filled in
    std::optional<std::string> value;  ///< as given, else as in the table, else nothing
    std::string place;                 ///< " (story.yaml, line 3)", or nothing
    bool is_list = false;
  };
  /// A line of the table and the NAME that it is for.
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
  std::map<std::string, const OptionSpec*, std::less<>> by_option_;  ///< those without NAME
  std::map<std::string_view, Lines> by_section_;
  std::map<std::string_view, Lines> named_;  ///< those with NAME, by section
  bool collect_idle_ = false;
  GivenOptions given_;    ///< ours
  GivenOptions petsc_;    ///< PETSc's
  GivenOptions ignored_;  ///< of the environment, neither
  std::map<std::string, std::vector<std::string>, std::less<>> names_;  ///< by section
  std::map<std::string, std::set<std::string, std::less<>>, std::less<>> known_names_;
  std::map<std::string, std::string, std::less<>> read_;  ///< values as read, by option
  std::set<std::string, std::less<>> idle_options_;
  std::vector<IdleKey> idle_;
};

/// "a, b and 7 more": at most six of the items.
std::string some_of(const std::vector<std::string>& items);

/// Throws InputError with rank 0's verdict on all ranks, unless it is empty: for what one rank
/// looks at and all must agree on. Collective; works before PetscInitialize too.
void throw_verdict(std::string verdict, MPI_Comm comm);

/// Throws InputError naming the first option of PETSc's database that nothing has asked for.
/// Collective; to be called after the first solve (MUMPS reads late). Viewers are exempt: they may
/// be asked for at the end. \param exempt  further names
void reject_unused_options(const std::set<std::string>& exempt = {});

/// Warns on rank 0's standard error of every option that nothing has asked for. To be called at the
/// end.
void warn_unused_options();

/// A table as text for a terminal, as Markdown, and as part of a man page (groff_man(7)).
std::string help_text(std::span<const OptionSpec> table);
std::string help_markdown(std::span<const OptionSpec> table);
std::string help_man(std::span<const OptionSpec> table);

/// Help of one topic: a section ("sheet"), a family of keys ("obstacle_leg") or a key in full
/// ("sheet_length", "sheet: length"); empty if there is no such thing.
std::string help_topic(std::span<const OptionSpec> table, std::string_view topic);

}  // namespace floe
