#include "session/solver_options.h"

#include <petsc.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include "options/option_names.h"
#include "options/option_values.h"

namespace floe {
namespace {

using enum Kind;

/// The ranges on which floe relies, beyond PETSc's own checks (3.18 to 3.22). PETSc checks some
/// options only after it has begun to compute, or never. Names are without the prefix of a solver.
constexpr std::array table{
    // time steps
    OptionSpec{"ts_dt", number, "", "s", "> 0", ""},
    OptionSpec{"ts_max_time", number, "", "s", "> 0", ""},
    OptionSpec{"ts_max_steps", integer, "", "", ">= 0", ""},
    OptionSpec{"ts_max_reject", integer, "", "", ">= -1", ""},
    OptionSpec{"ts_max_snes_failures", integer, "", "", ">= -1", ""},
    OptionSpec{"ts_rtol", number, "", "", ">= 0", ""},
    OptionSpec{"ts_atol", number, "", "", ">= 0", ""},
    OptionSpec{"ts_monitor_frequency", integer, "", "", ">= -1", ""},
    OptionSpec{"ts_adapt_safety", number, "", "", "> 0, <= 1", ""},
    OptionSpec{"ts_adapt_reject_safety", number, "", "", "> 0, <= 1", ""},
    OptionSpec{"ts_adapt_dt_min", number, "", "s", ">= 0", ""},
    OptionSpec{"ts_adapt_dt_max", number, "", "s", "> 0", ""},
    OptionSpec{"ts_adapt_max_ignore", number, "", "", ">= 0", ""},
    OptionSpec{"ts_adapt_scale_solve_failed", number, "", "", "> 0, < 1", ""},
    OptionSpec{"ts_adapt_time_step_increase_delay", integer, "", "", ">= 0", ""},
    OptionSpec{"ts_adapt_wnormtype", choice, "", "", "2 | infinity", ""},
    OptionSpec{"ts_liealpha_radius", number, "", "", ">= 0, <= 1", ""},
    OptionSpec{"ts_liealpha_hold", number, "", "", ">= 1", ""},
    // Newton's method
    OptionSpec{"snes_rtol", number, "", "", ">= 0, < 1", ""},
    OptionSpec{"snes_atol", number, "", "N", ">= 0", ""},
    OptionSpec{"snes_stol", number, "", "", ">= 0", ""},
    OptionSpec{"snes_max_it", integer, "", "", ">= 1", ""},
    OptionSpec{"snes_max_funcs", integer, "", "", ">= -1", ""},
    OptionSpec{"snes_max_fail", integer, "", "", ">= -1", ""},
    OptionSpec{"snes_max_linear_solve_fail", integer, "", "", ">= -1", ""},
    OptionSpec{"snes_divergence_tolerance", number, "", "", ">= -1", ""},
    OptionSpec{"snes_linesearch_max_it", integer, "", "", ">= 1", ""},
    OptionSpec{"snes_linesearch_order", integer, "", "", ">= 1, <= 3", ""},
    OptionSpec{"snes_linesearch_alpha", number, "", "", "> 0, < 1", ""},
    OptionSpec{"snes_linesearch_damping", number, "", "", "> 0, <= 1", ""},
    OptionSpec{"snes_linesearch_maxstep", number, "", "", "> 0", ""},
    OptionSpec{"snes_linesearch_minlambda", number, "", "", ">= 0, < 1", ""},
    OptionSpec{"snes_linesearch_rtol", number, "", "", ">= 0, < 1", ""},
    OptionSpec{"snes_linesearch_atol", number, "", "", ">= 0", ""},
    OptionSpec{"snes_linesearch_ltol", number, "", "", ">= 0", ""},
    OptionSpec{"ksp_ew_version", integer, "", "", ">= 1, <= 4", ""},
    OptionSpec{"ksp_ew_rtol0", number, "", "", ">= 0, < 1", ""},
    OptionSpec{"ksp_ew_rtolmax", number, "", "", ">= 0, < 1", ""},
    OptionSpec{"ksp_ew_gamma", number, "", "", ">= 0, <= 1", ""},
    OptionSpec{"ksp_ew_alpha", number, "", "", "> 1, <= 2", ""},
    OptionSpec{"ksp_ew_threshold", number, "", "", "> 0, < 1", ""},
    // linear solvers
    OptionSpec{"ksp_rtol", number, "", "", ">= 0, < 1", ""},
    OptionSpec{"ksp_atol", number, "", "", ">= 0", ""},
    OptionSpec{"ksp_divtol", number, "", "", "> 1", ""},
    OptionSpec{"ksp_max_it", integer, "", "", ">= 1", ""},
    OptionSpec{"ksp_gmres_restart", integer, "", "", ">= 1", ""},
    OptionSpec{"ksp_gmres_haptol", number, "", "", ">= 0", ""},
    OptionSpec{"ksp_gmres_breakdown_tolerance", number, "", "", ">= 0", ""},
    OptionSpec{"ksp_richardson_scale", number, "", "", "> 0", ""},
    OptionSpec{"ksp_chebyshev_esteig_steps", integer, "", "", ">= 0", ""},
    OptionSpec{"pc_factor_fill", number, "", "", ">= 1", ""},
    OptionSpec{"pc_factor_levels", integer, "", "", ">= 0", ""},
    OptionSpec{"pc_factor_zeropivot", number, "", "", ">= 0, <= 1e-3", ""},
    OptionSpec{"pc_factor_shift_amount", number, "", "", ">= 0", ""},
    OptionSpec{"pc_factor_column_pivot", number, "", "", ">= 0, <= 1", ""},
    OptionSpec{"pc_sor_omega", number, "", "", "> 0, < 2", ""},
    OptionSpec{"pc_sor_its", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_sor_lits", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_asm_overlap", integer, "", "", ">= 0", ""},
    OptionSpec{"pc_asm_blocks", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_asm_local_blocks", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_bjacobi_blocks", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_bjacobi_local_blocks", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_mg_levels", integer, "", "", ">= 1, <= 100", ""},
    OptionSpec{"pc_mg_multiplicative_cycles", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_gamg_process_eq_limit", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_gamg_coarse_eq_limit", integer, "", "", ">= 1", ""},
    OptionSpec{"pc_gamg_threshold_scale", number, "", "", ">= 0", ""},
    OptionSpec{"pc_gamg_agg_nsmooths", integer, "", "", ">= 0, <= 1", ""},
    OptionSpec{"pc_gamg_square_graph", integer, "", "", ">= 0", ""},
    OptionSpec{"pc_gamg_aggressive_coarsening", integer, "", "", ">= 0", ""},
    // matrices and MUMPS (numbers of the users' guide; PETSc itself sets the missing ones)
    OptionSpec{"mat_type", choice, "", "",
               "sbaij | seqsbaij | mpisbaij | baij | seqbaij | mpibaij | aij | seqaij | mpiaij",
               ""},
    OptionSpec{"mat_inode_limit", integer, "", "", ">= 1", ""},
    OptionSpec{"mat_mumps_icntl_4", integer, "", "", ">= 0, <= 4", ""},
    OptionSpec{"mat_mumps_icntl_6", integer, "", "", ">= 0, <= 7", ""},
    OptionSpec{"mat_mumps_icntl_7", choice, "", "", "0 | 2 | 3 | 4 | 5 | 6 | 7", ""},
    OptionSpec{"mat_mumps_icntl_8", choice, "", "",
               "-2 | -1 | 0 | 1 | 2 | 3 | 4 | 5 | 6 | 7 | 8 | 77", ""},
    OptionSpec{"mat_mumps_icntl_10", integer, "", "", ">= -100, <= 100", ""},
    OptionSpec{"mat_mumps_icntl_11", integer, "", "", ">= 0, <= 2", ""},
    OptionSpec{"mat_mumps_icntl_12", integer, "", "", ">= 0, <= 3", ""},
    OptionSpec{"mat_mumps_icntl_13", integer, "", "", ">= -1", ""},
    OptionSpec{"mat_mumps_icntl_14", integer, "", "%", ">= 0, <= 10000", ""},
    OptionSpec{"mat_mumps_icntl_15", choice, "", "", "0", ""},
    OptionSpec{"mat_mumps_icntl_19", choice, "", "", "0", ""},
    OptionSpec{"mat_mumps_icntl_20", choice, "", "", "0 | 10", ""},
    OptionSpec{"mat_mumps_icntl_22", choice, "", "", "0 | 1", ""},
    OptionSpec{"mat_mumps_icntl_23", integer, "", "MB", ">= 0", ""},
    OptionSpec{"mat_mumps_icntl_24", choice, "", "", "0 | 1", ""},
    OptionSpec{"mat_mumps_icntl_25", choice, "", "", "0", ""},
    OptionSpec{"mat_mumps_icntl_26", choice, "", "", "0", ""},
    OptionSpec{"mat_mumps_icntl_28", integer, "", "", ">= 0, <= 2", ""},
    OptionSpec{"mat_mumps_icntl_29", integer, "", "", ">= 0, <= 2", ""},
    OptionSpec{"mat_mumps_icntl_31", choice, "", "", "0", ""},
    OptionSpec{"mat_mumps_icntl_33", choice, "", "", "0 | 1", ""},
    OptionSpec{"mat_mumps_icntl_35", integer, "", "", ">= 0, <= 3", ""},
    OptionSpec{"mat_mumps_icntl_36", choice, "", "", "0 | 1", ""},
    OptionSpec{"mat_mumps_icntl_38", integer, "", "", ">= 0, <= 1000", ""},
    OptionSpec{"mat_mumps_cntl_1", number, "", "", ">= -1, <= 1", ""},
    OptionSpec{"mat_mumps_cntl_2", number, "", "", ">= 0", ""},
    OptionSpec{"mat_mumps_cntl_7", number, "", "", ">= 0", ""},
    OptionSpec{"vecstash_initial_size", integer, "", "", ">= 0", ""},
    // the session
    OptionSpec{"check_pointer_intensity", integer, "", "", ">= 0, <= 2", ""},
    OptionSpec{"log_threshold", number, "", "%", ">= 0", ""},
    OptionSpec{"malloc_view_threshold", number, "", "", ">= 0", ""},
};

struct Useless {
  std::string_view name, why;
};
constexpr auto no_mesh = "needs a mesh of PETSc's own, which floe has none of";
constexpr auto no_adjoint = "floe solves no adjoint equations";
/// Options with which PETSc would crash or write files that nothing reads.
constexpr std::array useless{Useless{"ksp_view_diagonal_scale", "PETSc crashes on it"},
                             Useless{"snes_convergence_estimate", no_mesh},
                             Useless{"ts_convergence_estimate", no_mesh},
                             Useless{"snes_monitor_fields", no_mesh},
                             Useless{"snes_monitor_ksp", "PETSc crashes on it"},
                             Useless{"snes_adapt_initial", no_mesh},
                             Useless{"snes_adapt_sequence", no_mesh},
                             Useless{"snes_grid_sequence", no_mesh},
                             Useless{"ts_adjoint_solve", no_adjoint},
                             Useless{"ts_save_trajectory", no_adjoint},
                             Useless{"pc_factor_in_place", "the matrix is needed again"}};

bool is_called(std::string_view name, std::string_view known) {
  return name == known || (name.size() > known.size() && name.ends_with(known) &&
                           name[name.size() - known.size() - 1] == '_');
}

std::string refused(std::string_view name, std::string_view value, const std::string& allowed) {
  return std::string(name) + ": " + (value.empty() ? "no value given," : shown(value)) +
         " must be " + allowed;
}

/// Whether PETSc's integers hold the value; -ts_max_steps is read by floe itself.
bool fits(std::string_view name, double value) {
  return name == "ts_max_steps" || std::abs(value) <= std::numeric_limits<PetscInt>::max();
}

bool is_number_in(std::string_view word, std::string_view range) {
  const auto x = to_number(word);
  return x && in_range(*x, range);
}

bool is_good(const OptionSpec& spec, std::string_view value) {
  if (spec.kind == integer) {
    const auto n = to_integer(value);
    return n && in_range(static_cast<double>(*n), spec.allowed) &&
           fits(spec.key, static_cast<double>(*n));
  }
  if (spec.kind == number) return is_number_in(value, spec.allowed);
  const auto words = choices_of(spec.allowed);
  return std::find(words.begin(), words.end(), value) != words.end();
}

std::string clip_problem(std::string_view name, std::string_view value) {
  const auto words = to_list(value).value_or(std::vector<std::string>{});
  if (words.size() == 2 && is_number_in(words[0], "> 0, <= 1") && is_number_in(words[1], ">= 1"))
    return {};
  return refused(name, value, "2 numbers: how much a step may shrink (> 0, <= 1), grow (>= 1)");
}

std::string lag_problem(std::string_view name, std::string_view value) {
  const auto n = to_integer(value);
  if (n && (*n == -2 || *n >= 1) && fits(name, static_cast<double>(*n))) return {};
  return refused(name, value, "an integer >= 1, or -2 (only once)");
}

/// Whether a word is nan or infinity in any spelling that C's readers accept.
bool is_no_number(std::string_view word) {
  std::string text;
  for (const char c : word) {
    if (c != '+' && c != '-')
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text == "inf" || text == "infinity" || text == "nan" || text.starts_with("nan(");
}

bool is_in_python(std::string_view name, std::string_view value) {
  return name == "python" || name.find("python_") != std::string_view::npos ||
         name.ends_with("_python") || (name.ends_with("_type") && value == "python");
}

std::string useless_problem(std::string_view name, std::string_view value) {
  if (is_in_python(name, value))
    return std::string(name) + ": solvers in Python cannot be used: floe runs no Python";
  const auto found = std::find_if(useless.begin(), useless.end(),
                                  [&](const Useless& u) { return is_called(name, u.name); });
  if (found == useless.end() || !to_flag(value).value_or(true)) return {};
  return std::string(name) + ": would have no use here: " + std::string(found->why);
}

/// The line of the table with the longest name that fits; null if there is none.
const OptionSpec* line_of(std::string_view name) {
  const OptionSpec* best = nullptr;
  for (const OptionSpec& spec : table) {
    if (is_called(name, spec.key) && (best == nullptr || spec.key.size() > best->key.size()))
      best = &spec;
  }
  return best;
}

std::string table_problem(std::string_view name, std::string_view value) {
  if (is_called(name, "ts_adapt_clip")) return clip_problem(name, value);
  if (is_called(name, "snes_lag_jacobian") || is_called(name, "snes_lag_preconditioner"))
    return lag_problem(name, value);
  const OptionSpec* line = line_of(name);
  return line == nullptr || is_good(*line, value) ? "" : refused(name, value, allowed_text(*line));
}

std::string finite_problem(std::string_view name, std::string_view value) {
  const auto words = to_list(value).value_or(std::vector<std::string>{});
  return std::any_of(words.begin(), words.end(), is_no_number) ? refused(name, value, "finite")
                                                               : "";
}

}  // namespace

std::string solver_option_problem(std::string_view name, std::string_view value) {
  for (const auto problem : {useless_problem, table_problem, finite_problem}) {
    if (std::string text = problem(name, value); !text.empty()) return text;
  }
  return {};
}

std::string solver_options_help(std::string_view topic) {
  std::string wanted(topic.substr(topic.starts_with('-') ? 1 : 0));
  while (wanted.ends_with(':') || wanted.ends_with('_')) wanted.pop_back();
  if (wanted.empty() || !is_petsc_option(wanted + "_")) return {};
  std::string text =
      "Options of PETSc's, for the command line or a scene; its manual explains them "
      "and has more:\nhttps://petsc.org/release/manualpages\n";
  for (const OptionSpec& line : table) {
    if (line.key != wanted && !line.key.starts_with(wanted + "_")) continue;
    std::string option = "  -" + std::string(line.key);
    option.resize(std::max<std::size_t>(option.size() + 1, 36), ' ');
    text += option + std::string(line.allowed) +
            (line.unit.empty() ? "" : " [" + std::string(line.unit) + "]") + "\n";
  }
  return text;
}

}  // namespace floe
