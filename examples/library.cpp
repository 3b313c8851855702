// library SCENE.yaml [-key value ...]: runs a scene of floe from a program of one's own, in steps
// of a tenth of its time, and prints what a coupled program would exchange.
#include <cstdio>

#include "floe/base/petsc.h"
#include "floe/session/command_line.h"
#include "floe/session/session.h"
#include "floe/simulation.h"

int main(int argc, char** argv) {
  floe::Mpi mpi(argc, argv);
  try {
    const floe::CommandLine line = floe::read_command_line(argc, argv);
    const floe::UserOptions options = floe::options_of(line);
    floe::Session session(argv[0], options);
    floe::Simulation simulation(floe::read_scene(line.scene, options));
    const double end = simulation.scene().time.end;
    int samples = 0;
    simulation.on_sample([&](const floe::Record&) { ++samples; });
    for (int tenth = 1; simulation.step_to(0.1 * tenth * end); ++tenth) {
      double top = 0;
      for (const floe::BodyState& body : simulation.bodies())
        if (body.position.z > top) top = body.position.z;
      std::printf("%.6g s: %d samples, highest body at %.4g m\n", simulation.time(), samples, top);
    }
    const floe::Results& results = simulation.results();
    std::printf("%s", results.text.c_str());
    return results.run.done ? 0 : 1;
  } catch (const floe::Verdict& error) {
    std::fprintf(stderr, "library: %s\n", error.what());
    return 2;
  }
}
