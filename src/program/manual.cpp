#include "manual.h"

#include "floe/scene.h"
#include "floe/session/version.h"
#include "subcommands.h"

namespace floe::program {
namespace {

constexpr auto before_tools = R"(.SH NAME
floe \- floating sea ice as rigid bodies joined by beams
.SH SYNOPSIS
.B floe
.I SCENE.yaml
.RB [ \-key
.IR value " ...]"
.br
.B mpiexec \-n
.I N
.B floe
.I SCENE.yaml
.RB [ \-key
.IR value " ...]"
.br
.B floe
.I TOOL
.RI [ arguments ]
.br
.B floe help
.RI [ TOPIC ]
.SH DESCRIPTION
A scene is a YAML file that says which sheet or blocks there are, what holds, moves and loads them,
and how the time goes on. A first word that is a file, or has '/' or '.' in it, is a scene. Results
go to the folder out/SCENE: summary.json, history.csv, lattice.h5, fields.h5 with fields.xmf for
ParaView, options.yaml, which repeats the run, and floe.log, which has all that the run said.
Paths in a scene are relative to the current folder.
.TP
.BR \-v ", " \-\-version
print the version of floe and of the libraries that it runs with
.TP
.BR \-h ", " \-\-help
print how floe is called
.TP
.B \-help
print all options of scenes
.TP
.B \-check
read, mesh and build everything, write nothing
.SH TOOLS
)";

constexpr auto after_tools = R"(.P
.B floe
.I TOOL
.B \-\-help
says more about each.
.SH OPTIONS
Options nest in a scene (sheet: {length: 40}) and join with '_' on the command line
(\-sheet_length 40), which wins. Lists are separated by commas or blanks. NAME stands for each name
of the section's list of names. An option that would have no effect is an error. Solver options are
PETSc's own (\-snes_*, \-ksp_*, \-pc_*, \-log_view, ...).
)";

constexpr auto after_options = R"(.SH EXIT STATUS
.TP
.B 0
done
.TP
.B 1
the run failed; what there was before it is written
.TP
.B 2
bad input: one line says which; nothing is written
.TP
.B 3
stopped on request (SIGTERM, SIGINT or a file STOP in the output folder), with a checkpoint
.SH ENVIRONMENT
.TP
.B FLOE
the floe that tools run, in place of the one that started them
.TP
.B OMP_NUM_THREADS
threads of each process in dense linear algebra; 1 is best with several processes
.SH EXAMPLES
.nf
floe /usr/share/floe/input/tension.yaml
floe plot_sheet out/tension
mpiexec \-n 2 floe scene.yaml \-sheet_thickness 1 \-output_dir out/thick
.fi
.SH SEE ALSO
The documentation beside the README: model.md (equations), options.md, accuracy.md, verification.md.
)";

}  // namespace

std::string manual_page() {
  std::string text = ".TH FLOE 1 \"\" \"floe " + version() + "\" \"User Commands\"\n";
  text += before_tools;
  for (const Subcommand& tool : subcommands())
    text += ".TP\n.B " + std::string(tool.name) + "\n" + std::string(tool.line) + "\n";
  return text + after_tools + options_man() + after_options;
}

}  // namespace floe::program
