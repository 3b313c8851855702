#include "options/option_names.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "options/option_values.h"
#include "options/spelling.h"

namespace floe {
namespace {

/// First words of the options of PETSc that a solver run can use; names that end in "_" are
/// prefixes. Inner solvers have prefixes of their own. The words are the names of PETSc's classes,
/// which change little: the list has those of all releases since 3.18, and test_petsc_options.cpp
/// queries the installed release for its options. An option of a family that the installed release
/// does not have is found after the first solve.
constexpr std::array petsc_families{
    // solvers and algebra
    "snes_", "ksp_", "pc_", "mat_", "vec_", "ts_", "tao_", "is_", "sf_", "dm_", "ao_", "matptap_",
    "matrart_", "matmatmult_", "mattransposematmult_", "matmattransmult_", "matmatmatmult_",
    "matstash_", "matden2sp_", "matis_", "vecstash_", "vecscatter_", "splitreduction_", "random_",
    "petscpartitioner_", "psubcomm_", "matmult_", "blas_",
    // inner solvers
    "mg_", "sub_", "npc_", "fieldsplit_", "redundant_", "telescope_", "esteig_", "inner_", "fas_",
    "pc_gamg_", "gamg_", "adapt_", "schur_", "bjkokkos_", "deflation_", "exotic_", "fetidp_",
    "galerkin_", "hmg_", "lsc_", "nn_", "pseudo_", "qn_", "redistribute_",
    // the session
    "log_", "options_", "viewer_", "malloc", "malloc_", "info", "info_", "on_error_", "fp_trap",
    "memory_view", "citations", "version", "skip_petscrc", "nox", "nox_warning",
    "no_signal_handler", "error_output_", "start_in_debugger", "stop_for_debugger", "debugger_",
    "debug_terminal", "display", "check_pointer_intensity", "objects_dump", "get_total_flops",
    "mpi_", "mpidump", "shared_tmp", "not_shared_tmp", "tmp", "draw_", "x_virtual", "saws_",
    "device_", "use_gpu_aware_mpi", "petsc_ci", "checkfunctionlist", "checkstack", "python",
    "python_", "dll_"};

/// Names that users often misspell, for a better hint than the family alone.
constexpr std::array petsc_names{"snes_type",
                                 "snes_rtol",
                                 "snes_atol",
                                 "snes_stol",
                                 "snes_max_it",
                                 "snes_monitor",
                                 "snes_view",
                                 "snes_converged_reason",
                                 "snes_linesearch_type",
                                 "ksp_type",
                                 "ksp_rtol",
                                 "ksp_atol",
                                 "ksp_max_it",
                                 "ksp_monitor",
                                 "ksp_view",
                                 "ksp_converged_reason",
                                 "pc_type",
                                 "pc_factor_mat_solver_type",
                                 "log_view",
                                 "options_left",
                                 "options_view"};

bool belongs(std::string_view name, std::string_view family) {
  return family.ends_with('_') ? name.starts_with(family) : name == family;
}

/// Returns the distance of `name` from a key: by spelling, or as the right word in the wrong
/// section.
int distance_to_key(std::string_view name, std::string_view key) {
  // The NAME of a named section is the user's own, so it is copied into the key, not compared.
  std::string known = option_name(key);
  if (const auto at = known.find("NAME"); at != std::string::npos) {
    const auto first = name.find('_');
    const auto second = first == std::string_view::npos ? first : name.find('_', first + 1);
    if (second != std::string_view::npos)
      known.replace(at, 4, name.substr(first + 1, second - first - 1));
  }
  const std::string_view word = key.substr(key.rfind(' ') + 1);
  int best = spelling_distance(name, known);
  constexpr int wrong_section = 2;
  for (std::size_t at = 0; at != std::string_view::npos;) {
    best = std::min(best, spelling_distance(name.substr(at), word) + wrong_section);
    const auto next = name.find('_', at);
    at = next == std::string_view::npos ? next : next + 1;
  }
  return best;
}

}  // namespace

bool is_option_word(std::string_view word) {
  if (word.size() < 2 || word[0] != '-') return false;
  if (word[1] == '-') return true;
  return std::isalpha(static_cast<unsigned char>(word[1])) && word != "-inf" && word != "-nan";
}

std::string petsc_name(std::string_view name) {
  std::string small = lower(name);
  return is_petsc_option(small) ? small : std::string(name);
}

bool reads_from_elsewhere(std::string_view name) {
  constexpr std::array<std::string_view, 5> words{
      "options_file", "options_file_yaml", "options_string_yaml", "prefix_push", "prefix_pop"};
  return std::find(words.begin(), words.end(), name) != words.end();
}

bool is_environment_option(std::string_view name) {
  if (!is_petsc_option(name) || reads_from_elsewhere(name) || name.size() > longest_petsc_option)
    return false;
  if (name == "version" || name == "skip_petscrc") return false;  // options for another kind of run
  return !name.starts_with("ts_") || name.starts_with("ts_monitor") || name == "ts_view";
}

bool is_petsc_option(std::string_view name) {
  return std::any_of(petsc_families.begin(), petsc_families.end(),
                     [&](std::string_view family) { return belongs(name, family); });
}

std::string nearest_petsc_option(std::string_view name) {
  const std::string_view family = name.substr(0, name.find('_') + 1);
  for (const std::string_view known : petsc_names) {
    if (known != name && known.starts_with(family) && spelling_distance(name, known) <= 2)
      return std::string(known);
  }
  return {};
}

std::string nearest_option(std::string_view option, std::span<const OptionSpec> table) {
  const std::string name = lower(option);
  std::string nearest;
  int best = std::max(2, static_cast<int>(name.size()) / 3) + 1;  // a farther name is no help
  const auto take = [&](std::string candidate, int far) {
    if (far < best) {
      best = far;
      nearest = std::move(candidate);
    }
  };
  for (const OptionSpec& spec : table) {
    take(std::string(spec.key), distance_to_key(name, spec.key));
    const std::string section(section_of(spec.key));
    if (!section.empty()) take(section + ":", spelling_distance(name, section));
  }
  for (const std::string_view known : petsc_names)
    take(std::string(known), spelling_distance(name, known));
  const auto cut = name.find('_');
  if (cut == std::string::npos) return nearest;
  const std::string first = name.substr(0, cut + 1), rest = name.substr(cut + 1);
  for (const std::string_view family : petsc_families) {
    // The rest of the name is not checked, so the first word must be nearly right.
    constexpr int misspelt = 2;
    const int far = spelling_distance(first, family);
    if (family.ends_with('_') && far > 0 && far <= misspelt) take(std::string(family) + rest, far);
  }
  return nearest;
}

}  // namespace floe
