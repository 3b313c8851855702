/// \file
/// A table of options and the one reader of their values. The table gives every option's name,
/// type, default, unit, range and doc; `floe -help`, docs/options.md and all error messages come
/// from it. Values lie in PETSc's options database (scene file, then command line) and are read as
/// text, because PETSc's own readers accept nan, too many numbers and trailing words.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "floe/base/petsc.h"

namespace floe {

/// What an option's text must be.
enum class Kind {
  flag,     ///< true or false; the bare word is true
  number,   ///< one finite number
  integer,  ///< one integer
  numbers,  ///< OptionSpec::count finite numbers
  choice,   ///< one of the words of OptionSpec::allowed
  choices,  ///< some of these words, none twice
  names,    ///< names of sections: lower-case letters and digits, none twice
  text,     ///< anything that is not empty
};

/// One line of the table.
struct OptionSpec {
  /// As in YAML: "sheet: length"; "boundary: NAME: fix" for each name of the list "boundary:
  /// names". With "_" instead of ": " it is the option of the command line and of PETSc's database.
  std::string_view key;
  Kind kind;
  /// Default as text; in parentheses if it is no value: "(required)", or what happens without the
  /// option.
  std::string_view fallback;
  std::string_view unit;  ///< empty: a pure number, or no number
  std::string_view
      allowed;  ///< numbers: "", "> 0", ">= 0" or "in (-1, 0.5)"; words: "one | two | three"
  std::string_view doc;
  int count = 1;  ///< of Kind::numbers
};

/// The options given to this run, read by the keys of the table. Every error is an InputError of
/// one line that names key, value and what is allowed; all ranks hold the same database, so all
/// ranks raise it.
class Options {
 public:
  /// Looks at everything in PETSc's database.
  /// \throws InputError if an option is neither in the table nor of one of PETSc's families, with
  /// the
  ///         nearest known name; or if a section NAME is not listed in `names`, or listed without a
  ///         section.
  explicit Options(std::span<const OptionSpec> table);

  /// Whether an option has been given. `name` stands for NAME in the key.
  bool given(std::string_view key, std::string_view name = {}) const;
  /// Whether any option of a section ("sheet") has been given; empty sections count as absent.
  bool given_section(std::string_view section) const;
  /// Throws if `key` (an option or a whole section) has been given: "KEY: WHY".
  void refuse(std::string_view key, std::string_view why) const;

  // Each option is read once, by one of these. Without a value in the table `otherwise` is taken.
  bool flag(std::string_view key, std::string_view name = {});
  double number(std::string_view key, std::string_view name = {},
                std::optional<double> otherwise = {});
  std::int64_t integer(std::string_view key, std::string_view name = {});
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

  /// Throws for the first option that has been given but was not read: it would have no effect.
  void reject_unread() const;
  /// Every option as read so far, and PETSc's as given, as YAML that repeats the run.
  std::string yaml() const;

 private:
  struct Reading {
    const OptionSpec& spec;
    std::string label;                 ///< key with NAME filled in
    std::optional<std::string> value;  ///< as given, else as in the table, else nothing
  };
  const OptionSpec& spec(std::string_view key) const;
  Reading read(std::string_view key, std::string_view name);
  void record(const Reading& reading, std::string value);
  void read_numbers(std::string_view key, std::string_view name, std::span<double> values);
  int read_choice(std::string_view key, std::string_view name);
  void read_names();
  void sort_given(const std::vector<std::pair<std::string, std::string>>& database);
  bool is_section(std::string_view option) const;
  void check_name_of(std::string_view option) const;
  void check_sections_of_names() const;

  std::span<const OptionSpec> table_;
  std::map<std::string, std::string, std::less<>> given_;   ///< ours, by the name in the database
  std::vector<std::pair<std::string, std::string>> petsc_;  ///< PETSc's
  std::map<std::string, std::vector<std::string>, std::less<>> names_;  ///< by section
  std::map<std::string, std::string, std::less<>>
      read_;  ///< values as read, by name in the database
};

/// Throws InputError with rank 0's verdict on all ranks, unless it is empty: for what one rank
/// looks at and all must agree on. Collective; works before PetscInitialize too.
void throw_verdict(std::string verdict, MPI_Comm comm);

/// Throws InputError naming the first option of PETSc's database that nothing has asked for.
/// Collective; to be called after the first solve (MUMPS reads late). Viewers are exempt: they may
/// be asked for at the end.
void reject_unused_options();

/// Warns on rank 0's standard error of every option that nothing has asked for. To be called at the
/// end.
void warn_unused_options();

/// A table as text for a terminal, as Markdown, and as part of a man page (groff_man(7)).
std::string help_text(std::span<const OptionSpec> table);
std::string help_markdown(std::span<const OptionSpec> table);
std::string help_man(std::span<const OptionSpec> table);

}  // namespace floe
