#include "subcommands.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "places.h"
#include "program.h"

namespace floe::program {
namespace {

constexpr std::array table{
    Subcommand{"plot_sheet", "draws a sheet and its beams, coloured by stress"},
    Subcommand{"plot_deflection", "draws deflections against those of an infinite plate"},
    Subcommand{"plot_fragments", "draws the pieces of a sheet that broke"},
    Subcommand{"plot_load", "draws the forces on obstacles against time"},
    Subcommand{"plot_motion", "draws the motion of a structure and the spectrum of its velocity"},
    Subcommand{"plot_pressure", "draws the local pressures on an obstacle: maps, against area"},
    Subcommand{"loads", "a load's mean, maxima, Gumbel's law, peaks; of one run or of many"},
    Subcommand{"netcdf", "writes runs as netCDF-4 by the CF conventions"},
    Subcommand{"vtkhdf", "writes the frames of a run as VTKHDF with time"},
    Subcommand{"report", "one HTML file of a run or an ensemble, with its scene to turn and play"},
    Subcommand{"render", "pictures and films of a run in space (needs ParaView)"},
    Subcommand{"make_lattice", "writes lattices of one's own: frames, regular sheets, blocks"},
    Subcommand{"make_floes", "makes fields of floes: concentration, sizes, shapes, leads"},
    Subcommand{"make_ridge", "makes ridges of blocks: sail, keel, frozen to a depth"},
    Subcommand{"make_line", "makes tables of mooring lines that hang and lie on the seabed"},
    Subcommand{"make_hull", "makes the hull of a ship as a closed surface of triangles (STL)"},
    Subcommand{"make_parts", "divides solids (STL, OBJ) into the convex parts that contact needs"},
    Subcommand{"strength", "the strength of whole sheets over that of their beams"},
    Subcommand{"ensemble", "runs a scene many times: seeds, and parameters that are varied"},
    Subcommand{"campaign", "all sheets and tests of the paper"},
    Subcommand{"campaign_report", "figures and report of a campaign"},
};

}  // namespace

std::span<const Subcommand> subcommands() { return table; }

bool is_subcommand(std::string_view word) {
  return std::any_of(table.begin(), table.end(),
                     [&](const Subcommand& known) { return known.name == word; });
}

int run_subcommand(char** argv) {
  const std::string name = argv[0];
  if (ranks_of_launcher() > 1) {
    if (!is_first_rank()) return done;  // see say()
    std::fprintf(stderr, "floe %s: is one process: start it without mpiexec\n", name.c_str());
    return bad_input;
  }
  const auto folder = share_folder();
  if (folder.empty()) {
    std::fprintf(stderr, "floe %s: the tools that belong to %s are not there\n", name.c_str(),
                 program_file().c_str());
    return failed;
  }
  const std::string tool = folder / "tools" / name;
  // The tool runs this floe, unless the user names another.
  setenv("FLOE", program_file().c_str(), 0);
  argv[0] = const_cast<char*>(tool.c_str());  // NOLINT: execv's words are not const
  execv(tool.c_str(), argv);
  const char* why = std::strerror(errno);
  const bool there = access(tool.c_str(), X_OK) == 0;
  std::fprintf(stderr, "floe %s: %s: %s%s\n", name.c_str(), tool.c_str(), why,
               there ? " (the tools need /usr/bin/python3)" : "");
  return failed;
}

}  // namespace floe::program
