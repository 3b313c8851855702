// floe SCENE.yaml [-key value ...]: runs a scene, in the order of docs/architecture.md, "One run".

#include <malloc.h>

#include <optional>
#include <string>
#include <utility>

#include "files/files.h"
#include "files/run_log.h"
#include "floe/base/petsc.h"
#include "floe/files/log.h"
#include "floe/options/options.h"
#include "floe/scene/restart.h"
#include "floe/session/command_line.h"
#include "floe/session/session.h"
#include "floe/session/unused_options.h"
#include "floe/simulation.h"
#include "program/go_on.h"
#include "program/log_heading.h"
#include "program/program.h"
#include "program/signals_at_start.h"
#include "session/signals.h"
#include "simulation/scene_run.h"
#include "simulation/summary.h"

namespace {

using enum floe::program::Exit;

void say(const std::string& text) {
  if (floe::rank() == 0) floe::print(text);
}
void say_error(const std::string& text) {
  if (floe::rank() == 0) floe::print_error(text);
}

/// Makes the system take back arrays above 1 MB when they are freed, or the memory of a large
/// sheet's set-up would be kept for the whole run. To be called after MPI_Init, since Open MPI
/// switches that off.
void give_memory_back() {
  mallopt(M_MMAP_MAX, 1 << 16);
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
}

/// The user's request.
struct Wish {
  const floe::program::Words& words;  ///< the command
  const floe::UserOptions& options;
  const floe::Restart& restart;
};

/// Whether the run of a restart by `auto` is done already; it is not repeated.
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

/// Prints how a run ended. \return the exit code
int report(const floe::Results& results, const floe::Scene& scene, const std::string& go_on) {
  const floe::RunResult& run = results.run;
  say(results.text);
  say("results: " + scene.output.dir +
      "/ (summary.json, history.csv, floe.log; fields.xmf for ParaView)\n");
  const bool goes_on = run.stopped && scene.integrator != floe::Integrator::quasistatic;
  const std::string how = goes_on ? "; go on with: " + go_on : "";
  if (!run.done) say_error("floe: " + run.message + how + "\n");
  if (run.unstable_modes > 0)
    say_error("floe: warning: the equilibrium is unstable (" + std::to_string(run.unstable_modes) +
              " negative eigenvalues of its tangent): the least disturbance would end it\n");
  floe::warn_unused_options();
  return run.done ? done : run.stopped ? stopped : failed;
}

/// Makes a run. \param simulation  set, for the caller that says how an error ended the run
int run(const Wish& user, std::optional<floe::Simulation>& simulation) {
  using namespace floe;
  const double began = MPI_Wtime();

  // 1. The scene
  Scene scene = read_scene(user.restart.scene, user.options);
  if (is_done(scene, user.restart)) return done;
  for (const std::string& remark : user.restart.remarks) scene.remarks.push_back(remark);

  // 2. The lattice and the model
  simulation.emplace(std::move(scene), SimulationSettings{.talks = true, .began = began});

  // 3. The run
  const Results& results = simulation->run();
  if (simulation->scene().check_only) return done;

  // 4. The results
  const std::string go_on =
      program::command_to_go_on(user.words, checkpoint_file(simulation->scene()), size());
  return report(results, simulation->scene(), go_on);
}

/// Makes the run. If an error ends it, prints one line; its folder says so already.
int run_to_an_end(const Wish& user) {
  std::optional<floe::Simulation> simulation;
  const auto end = [&](const floe::Verdict& why, int code) {
    say_error(std::string("floe: ") + why.what() + "\n");
    return code;
  };
  try {
    return run(user, simulation);
  } catch (const floe::InputError& error) {
    return end(error, bad_input);
  } catch (const floe::Stopped& error) {
    return end(error, stopped);
  } catch (const floe::RunFailed& error) {
    return end(error, failed);
  }
}

/// Reads the command line and the scene, and makes the run.
int run_command(int argc, char** argv, const floe::program::Words& words,
                floe::StopSignals& signals) {
  int code = bad_input;
  try {
    const floe::CommandLine line = floe::read_command_line(argc, argv);
    floe::UserOptions options = floe::options_of(line, floe::program::near_scene);
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
