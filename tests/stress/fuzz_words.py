"""Words of the command line, and options of PETSc, to try."""
from fuzz_keys import ODD

# Of PETSc's families; some are floe's, some of the libraries below, some of nobody.
PETSC = """
ts_type ts_dt ts_max_time ts_max_steps ts_rtol ts_atol ts_monitor ts_view ts_adapt_type
ts_adapt_safety ts_adapt_clip ts_adapt_dt_min ts_adapt_dt_max ts_adapt_monitor
ts_adapt_wnormtype ts_rk_type ts_liealpha_radius ts_liealpha_hold ts_max_reject
ts_max_snes_failures ts_exact_final_time ts_init_time ts_time_span ts_eval_times
ts_monitor_solution ts_save_trajectory ts_theta_theta ts_alpha_radius ts_error_if_step_fails
ts_equation_type ts_converged_reason ts_event_tol ts_rk_multirate snes_type snes_rtol snes_atol
snes_stol snes_max_it snes_max_funcs snes_max_fail snes_monitor snes_view snes_lag_jacobian
snes_lag_preconditioner snes_linesearch_type snes_linesearch_damping snes_linesearch_max_it
snes_linesearch_order snes_converged_reason snes_test_jacobian snes_mf snes_mf_operator snes_fd
snes_fd_color snes_force_iteration snes_ksp_ew snes_grid_sequence snes_trtol snes_npc_side
snes_monitor_cancel snes_error_if_not_converged snes_divergence_tolerance snes_convergence_test
snes_tr_delta0 ksp_type ksp_rtol ksp_atol ksp_divtol ksp_max_it ksp_monitor ksp_view
ksp_gmres_restart ksp_initial_guess_nonzero ksp_norm_type ksp_pc_side ksp_converged_reason
ksp_error_if_not_converged ksp_reuse_preconditioner ksp_view_mat ksp_view_rhs ksp_view_solution
ksp_lag_norm ksp_check_norm_iteration ksp_chebyshev_eigenvalues ksp_richardson_scale pc_type
pc_factor_mat_solver_type pc_factor_levels pc_factor_fill pc_factor_shift_type
pc_factor_shift_amount pc_factor_mat_ordering_type pc_factor_reuse_ordering pc_factor_zeropivot
pc_sor_omega pc_sor_its pc_jacobi_type pc_gamg_type pc_gamg_threshold pc_mg_levels
pc_asm_overlap pc_bjacobi_blocks pc_fieldsplit_type pc_composite_pcs pc_hypre_type sub_pc_type
mg_levels_ksp_type mat_type mat_mumps_icntl_1 mat_mumps_icntl_2 mat_mumps_icntl_3
mat_mumps_icntl_4 mat_mumps_icntl_6 mat_mumps_icntl_7 mat_mumps_icntl_8 mat_mumps_icntl_10
mat_mumps_icntl_11 mat_mumps_icntl_13 mat_mumps_icntl_14 mat_mumps_icntl_22 mat_mumps_icntl_23
mat_mumps_icntl_24 mat_mumps_icntl_28 mat_mumps_icntl_29 mat_mumps_icntl_35 mat_mumps_icntl_99
mat_mumps_cntl_1 mat_mumps_cntl_3 mat_mumps_cntl_4 mat_mumps_cntl_5 mat_view mat_block_size
mat_no_inode mat_inode_limit vec_type vec_view vecscatter_view log_view log_trace log_summary
log_sync log_exclude info malloc_debug malloc_test malloc_dump malloc_view malloc_hbw
memory_view fp_trap options_left options_view options_monitor options_file options_string
check_pointer_intensity error_output_stdout on_error_abort no_signal_handler get_total_flops
citations history nox display dm_view dm_mat_type tao_type eps_type bogus foo_type snes_bogus
ts_bogus prefix_snes_rtol use_gpu_aware_mpi cuda_device petsc_ci_tmp skip_petscrc help version v
""".split()

VALUES = (*ODD, "none", "basic", "rk", "leapfrog", "liealpha", "euler", "bdf", "alpha2", "4", "5dp",
          "3bs", "1fe", "2a", "8vr", "newtonls", "newtontr", "ksponly", "nrichardson", "ngmres",
          "fas", "bt", "l2", "cp", "gmres", "cg", "preonly", "minres", "bcgs", "richardson",
          "chebyshev", "lu", "cholesky", "ilu", "icc", "jacobi", "sor", "gamg", "mg", "asm",
          "bjacobi", "none", "mumps", "petsc", "superlu_dist", "cholmod", "aij", "sbaij", "baij",
          "dense", "shell", "mpi", "seq", "::ascii_info", "ascii:o.txt", "binary:o.bin", "draw",
          ":o.txt", ":/nowhere/o", "hdf5:o.h5", "1e-3", "1e-12", "0.5", "3", "10", "-2", "-3",
          "1e-8,1e-8", "0.1,10", "3,2", "0,1", "l2norm", "unpreconditioned", "left", "right",
          "symmetric", "matchstep", "stepover", "interpolate", "nonzero", "positive_definite",
          "inblocks", "nd", "rcm", "natural", "qmd")

WORDS = ("-help", "--help", "-h", "help", "-version", "--version", "-V", "-check", "--check",
         "-help_markdown", "-help_man", "-", "--", "---", "-=", "=", "-sheet", "-sheet:", "-sheet_",
         "-_", "-1", "-1e3", "", " ", "-é", "-sheet_length=3", "--sheet_length", "-sheet-length",
         "-sheet:length", "sheet_length", "-SHEET_LENGTH", "-boundary_left_set", "-x" * 400,
         "-help sheet", "nowhere.yaml", "s.yaml", ".", "/dev/null", "/", "..", "-options_file",
         "-scene", "-np", "-n", "-forces", "-output_dir", "-time_end", "-limit_steps",
         "-checkpoint_restart", "-lattice_file", "-check false", "-report", "-output_overwrite",
         "make_lattice", "plot_sheet", "-ts_max_steps")

# \udcff stands for a byte 255
BYTES = ("a\nb", "a\tb", "\x1b[31m", "\x07", "a\udcff", "\udce4pfel", "\u2028", "\u202e", "\r")


def petsc_options(chance):
    """[(name, value or None)]"""
    options = []
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        name = chance.choice(PETSC)
        options.append((name, None if chance.random() < 0.15 else chance.choice(VALUES)))
    return options


def command_line(scenes, scene, chance):
    """Words after the scene, or around it: keys with values, words of no meaning, in any order."""
    words = []
    for _ in range(chance.choice((1, 1, 2, 3, 8))):
        way = chance.random()
        if way < 0.6:
            key = chance.choice(scenes.keys)
            name = "-" + "_".join(scenes.place(key, scene, chance))
            value = key.hostile(chance) if chance.random() < 0.3 else scenes.value(key, scene,
                                                                                   chance)
            value = value.strip("[]").replace(", ", ",") if chance.random() < 0.8 else value
            value = chance.choice(BYTES) if chance.random() < 0.04 else value
            words += chance.choice(([name, value], [name, value], [name, value],
                                    [f"{name}={value}"],
                                    ["-" + name, value], [name]))
        elif way < 0.85:
            words += chance.choice(WORDS).split(" ") if chance.random() < 0.9 else [
                chance.choice(WORDS), chance.choice(ODD)]
        else:
            words.append(chance.choice((*ODD, *BYTES)))
    return [word.replace("\0", "") for word in words]
