// floe SCENE.yaml [-key value ...]: reads like the method section of a paper.

#include <malloc.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "floe/base/command_line.h"
#include "floe/base/environment.h"
#include "floe/base/files.h"
#include "floe/base/log.h"
#include "floe/base/options.h"
#include "floe/base/petsc.h"
#include "floe/base/run_log.h"
#include "floe/base/run_place.h"
#include "floe/base/scene_text.h"
#include "floe/base/signals.h"
#include "floe/base/version.h"
#include "floe/build.h"
#include "floe/lattice/folded.h"
#include "floe/output/output.h"
#include "floe/output/run_folder.h"
#include "floe/restart.h"
#include "program/go_on.h"
#include "program/log_heading.h"
#include "program/program.h"
#include "program/signals_at_start.h"

namespace {

using enum floe::program::Exit;

void say(const std::string& text) {
  if (floe::rank() == 0) floe::print(text);
}
void say_error(const std::string& text) {
  if (floe::rank() == 0) floe::print_error(text);
}

/// Arrays above 1 MB come from the system and go back to it when they are freed, or the peak of a
/// large sheet's set-up would be kept for the whole run. After MPI_Init: Open MPI switches that
/// off.
void give_memory_back() {
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
}

/// The initial state, kept until the output folder is there.
template <class Space>
struct First {
  floe::State<Space> state;
  floe::Wrenches<Space> wrenches;
  std::vector<std::pair<std::string, double>> columns, forces;
};

/// What a run starts from.
struct Start {
  double time;
  std::optional<floe::RunFolder>& folder;
  floe::MeshReport mesh;
  floe::Lattice lattice;
  floe::Skips skips;
  std::string go_on;  ///< the command that goes on where this one stops
};

using Columns = std::vector<std::pair<std::string, double>>;

std::vector<std::string> names_of(const Columns& forces, const Columns& integrator) {
  std::vector<std::string> names;
  for (const Columns* columns : {&forces, &integrator}) {
    for (const auto& [name, value] : *columns) names.push_back(name);
  }
  return names;
}

/// The files of another run would be cut back.
void require_same_run(const floe::Scene& scene, const floe::RunFolder& folder,
                      const std::string& run) {
  if (run.empty())
    throw floe::InputError("checkpoint: restart: '" + scene.checkpoint.restart +
                           "': output/run is empty");
  if (folder.run().empty() || folder.run() == run) return;  // empty: copied without its .lock
  throw floe::InputError("checkpoint: restart: '" + scene.checkpoint.restart +
                         "' is of another run than the files in " + scene.output.dir +
                         "; a run goes on in the folder where it began");
}

template <class Space>
int run(const floe::Scene& scene, Start& start) {
  using namespace floe;
  Lattice& lattice = start.lattice;

  run_place().stage = "before the first state";
  const std::string lattice_id = fingerprint(lattice);
  const OutputSize size_of_output =
      output_size(lattice, scene.forces.fracture, scene.boundaries.size(), scene.loads.size(),
                  scene.obstacles.size());
  Folded folded;
  if (!needs_shapes(scene)) folded.fold_shapes(lattice);

  // 3. The model: this rank's part of the lattice, boundaries, forces
  const std::vector<PlacedLoad> loads = place_loads(scene, lattice);
  Model<Space> model(lattice, PETSC_COMM_WORLD, scene.boundaries);
  add_forces(scene, loads, model);
  add_contact(scene, lattice, model);
  const bool is_static = scene.integrator == Integrator::quasistatic;
  if (is_static) hold_free_motions(scene, lattice, model);
  std::optional<OutOfPlane> rest;
  if (is_static && start.skips.planar) rest = out_of_plane(scene, lattice, loads, model.part());
  release_setup(scene, model);
  folded.fold_shapes(lattice);
  folded.fold_beams(lattice);
  if (size() == 1) folded.fold_bodies(lattice, model.part().bodies);

  // 4. Output, opened once every option is known to be understood: bad input leaves no folder
  // behind. Solvers read some of theirs during the first step.
  RunFolder* const folder = start.folder ? &*start.folder : nullptr;
  std::unique_ptr<Output<Space>> output;
  std::optional<OutputMemory> restart;  // what a checkpoint says of the files to go on with
  std::optional<First<Space>> first;
  // Bad input ends with one line: what may be meant so is said once the run is known to be
  // possible.
  const auto say_warnings = [&] {
    for (const std::string& warning : scene.warnings) say_error("floe: warning: " + warning + "\n");
  };
  const auto open = [&](const std::vector<std::string>& columns) {
    reject_unused_options(scene.unused_options);
    if (restart) {
      require_same_run(scene, *folder, restart->run);
      require_files(scene.output.dir, *restart,
                    columns_of(scene.boundaries, scene.loads, columns, scene.forces.fracture),
                    PETSC_COMM_WORLD);
    }
    say_warnings();
    folder->begin(restart ? restart->run : "");
    if (restart) make_newest(scene.checkpoint.restart, checkpoint_file(scene), PETSC_COMM_WORLD);
    start.mesh.keep();
    start.mesh.keep = [] {};
    if (rank() == 0) folded.unfold(lattice);  // others need no geometry but places
    output = std::make_unique<Output<Space>>(
        OutputOptions{scene.output.dir, scene.output.history, scene.output.fields},
        std::move(lattice), model, loads, scene.options_yaml, restart ? &*restart : nullptr);
    if (first)
      output->accept({first->state, first->wrenches, 0, first->columns, false, first->forces});
    first.reset();
  };

  // 5. Run
  const auto prepare = [&](const std::vector<std::string>& columns) {
    if (!output) open(columns);
  };
  const auto observe = [&](const Accepted<Space>& accepted) {
    if (accepted.step == 0 && scene.integrator != Integrator::leapfrog) {
      first = First<Space>{accepted.state, accepted.wrenches, accepted.columns, accepted.forces};
      return;
    }
    prepare(names_of(accepted.forces, accepted.columns));
    output->accept(accepted);
    folder->note(accepted.state.time, accepted.step);
    run_place() = {"", accepted.state.time, accepted.step, 0};
  };
  const auto remember = [&](Memory& checkpoint) {
    if (checkpoint.loading()) {
      restart.emplace().remember(checkpoint);
    } else {
      OutputMemory files = output->memory();
      files.run = folder->run();
      files.remember(checkpoint);
    }
  };
  // A checkpoint must not outlive the files that it knows of.
  const auto before_checkpoint = [&](const std::vector<std::string>& columns) {
    prepare(columns);
    output->sync();
  };
  const auto on_plan = [&](const RunPlan& plan) {
    const std::string text =
        plan_text(scene, plan, size_of_output, 1e6 * resident_memory_mb(PETSC_COMM_WORLD));
    if (scene.check_only) say_warnings();
    say(text);
    return !scene.check_only;
  };
  const RunResult result = integrate(scene, model, rest ? &*rest : nullptr, lattice_id, on_plan,
                                     observe, before_checkpoint, remember);
  if (scene.check_only) {
    say("scene is valid: " + std::to_string(model.part().global_bodies) + " bodies, " +
        std::to_string(model.part().global_beams) + " beams\n");
    return done;
  }
  prepare({});  // a run that found not even a first state leaves a summary that says so
  const bool goes_on = result.stopped && !is_static;  // where it was
  if (!goes_on) output->finish();

  // 6. Results
  const Summary summary = summarise(scene, start.skips, model, start.mesh, result, output->first(),
                                    output->last(), MPI_Wtime() - start.time);
  folder->finish(summary.json);
  say(summary.text);
  say("results: " + scene.output.dir +
      "/ (summary.json, history.csv, floe.log; fields.xmf for ParaView)\n");
  const std::string how = goes_on ? "; go on with: " + start.go_on : "";
  if (!result.done) say_error("floe: " + result.message + how + "\n");
  if (result.unstable_modes > 0)
    say_error("floe: warning: the equilibrium is unstable (" +
              std::to_string(result.unstable_modes) +
              " negative eigenvalues of its tangent): the least disturbance would end it\n");
  warn_unused_options();
  return result.done ? done : result.stopped ? stopped : failed;
}

/// What a user has asked for.
struct Wish {
  const floe::program::Words& words;  ///< the command
  const floe::UserOptions& options;
  const floe::Restart& restart;
};

/// With `auto` a run that is done is not made again.
bool is_done(const floe::Scene& scene, const floe::Restart& restart) {
  constexpr double rounding = 1e-12;
  const std::string& dir = restart.done_in;
  if (dir.empty()) return false;
  if (scene.time.end > (1 + rounding) * restart.done_end) {
    if (!restart.file.empty()) return false;
    throw floe::InputError("time: end: the run in " + dir +
                           " is done and has left no checkpoint to go on from; a section "
                           "'checkpoint' would have made it leave one");
  }
  say("the run in " + dir + " is done already; nothing is touched\n");
  return true;
}

/// \param folder  where the results go, for who ends the run; none if the scene is only checked
int run(const Wish& user, std::optional<floe::RunFolder>& folder) {
  using namespace floe;
  Start start{MPI_Wtime(), folder, {}, {}, {}, {}};

  // 1. The scene, and the lock of its output folder
  Scene scene = read_scene(user.restart.scene, user.options);
  if (is_done(scene, user.restart)) return done;
  check_reports(scene);
  for (const std::string& remark : user.restart.remarks) scene.remarks.push_back(remark);
  start.go_on = program::command_to_go_on(user.words, checkpoint_file(scene), size());
  const FolderWish wish{scene.output.dir, scene.path, scene.inputs, scene.output.overwrite,
                        !scene.checkpoint.restart.empty()};
  if (!scene.check_only) {
    folder.emplace(wish, PETSC_COMM_WORLD);
    set_last_words([&folder](const std::string& why) {
      if (folder && (folder->has_begun() || run_place().code == failed)) {
        folder->fail(why);
      } else {
        folder.reset();  // nothing of it is left
      }
    });
  }

  // 2. Sheet -> lattice, and what it does not need
  run_place().stage = "while the lattice was made";
  start.lattice = make_lattice(scene, PETSC_COMM_WORLD, start.mesh);
  stop_if_asked(PETSC_COMM_WORLD);
  set_initial(scene, start.lattice);
  if (start.mesh.strength) strengthen(scene, *start.mesh.strength);
  start.skips = skips_of(scene, start.lattice);
  for (const std::string& remark : scene.remarks) say(remark + "\n");
  const std::string& why = start.skips.needs_space;
  say("model: " + start.skips.text + (why.empty() ? "" : " (" + why + ")") + "\n");
  const std::string processors = built_for(PETSC_COMM_WORLD);
  const bool mixed = processors != built_for();
  say("library: built for " + processors +
      (mixed ? "; results differ by rounding from those of one level\n" : "\n"));

  if (start.mesh.strength) say("strength: " + text_of(*start.mesh.strength) + "\n");

  const int code = start.skips.planar ? run<Planar>(scene, start) : run<Spatial>(scene, start);
  if (scene.check_only) {
    const std::string problem = RunFolder::problem(wish, PETSC_COMM_WORLD);
    if (!problem.empty()) say("but a run would be refused now: " + problem + "\n");
  }
  return code;
}

/// The run, and how it ends if something ends it: one line, and what the folder should say.
int run_to_an_end(const Wish& user) {
  std::optional<floe::RunFolder> folder;
  const auto end = [&](const floe::Verdict& why, int code) {
    if (folder && floe::rank() == 0 && (folder->has_begun() || code == failed))
      folder->fail(why.what());
    say_error(std::string("floe: ") + why.what() + "\n");
    folder.reset();
    floe::set_last_words({});
    return code;
  };
  try {
    const int code = run(user, folder);
    floe::set_last_words({});
    return code;
  } catch (const floe::InputError& error) {
    return end(error, bad_input);
  } catch (const floe::Stopped& error) {
    return end(error, stopped);
  } catch (const floe::RunFailed& error) {
    return end(error, failed);
  }
}

/// The scene's run.
int run_command(int argc, char** argv, const floe::program::Words& words,
                floe::StopSignals& signals) {
  int code = bad_input;
  try {
    const floe::CommandLine line = floe::read_command_line(argc, argv);
    floe::UserOptions options{floe::read_environment(line.petscrc), {}, line.options};
    if (!line.scene.empty())
      options.scene = floe::read_scene_text(line.scene, MPI_COMM_WORLD, floe::program::near_scene);
    const floe::Restart restart = floe::find_restart(line.scene, options);
    floe::Session session(argv[0], options);
    signals.arm();
    give_memory_back();
    code = run_to_an_end({words, options, restart});
  } catch (const floe::InputError& error) {
    if (floe::rank(MPI_COMM_WORLD) == 0)
      floe::print_error(std::string("floe: ") + error.what() + "\n");
  }
  if (code == bad_input) floe::drop_petsc_files();
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  floe::program::restore_signals();
  floe::open_closed_streams();
  if (const auto code = floe::program::answer(argc, argv)) return *code;
  if (const floe::Help help = floe::wants_help(argc, argv); help.kind != floe::Help::none)
    return floe::program::print_options(help);
  const floe::program::Words words(argv, argv + argc);
  floe::StopSignals signals;
  floe::Mpi mpi(argc, argv);
  if (floe::rank(MPI_COMM_WORLD) == 0) floe::keep_log(floe::program::log_heading(argc, argv));
  const int code = run_command(argc, argv, words, signals);
  floe::close_log("ended " + floe::date_and_time() + " with exit code " + std::to_string(code) +
                  "\n");
  return code;
}
