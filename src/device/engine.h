/// \file
/// Back ends that keep the motion of bodies in memory of their own and step it there.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "floe/geometry/half_space.h"
#include "geometry/edge_graph.h"

namespace floe::device {

/// An error of a device or of its library.
struct Failed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Still water; per body as DeviceWater.
struct Water {
  double weight_density = 0, linear = 0, coefficient = 0;
  bool drags = false, level_moves = false, by_points = false;
  int pace = 1;
  std::vector<std::array<double, 14>> prisms;
  std::vector<std::array<double, 4>> wholes;
  std::vector<double> extents, most2, area_per_volume;
  /// Per body and per face, and one more: where its vertices, faces and corners begin.
  std::vector<std::int32_t> first_vertex{0}, first_face{0}, first_corner{0};
  std::vector<std::int32_t> corners;
  std::vector<std::array<double, 3>> vertices;
};

/// Breakable beams of a lattice (src/fracture).
struct Breaking {
  /// Numbers of a beam: its strengths (5), area [m^2], G_f and G_s [J/m^2], the middle between its
  /// ends at rest (3) [m], what Criterion::general needs (3).
  enum Number : int { area = 5, toughness = 6, middle = 8, further = 11, numbers = 14 };
  bool general = false;  ///< Criterion::general
  bool crushes = false;
  std::vector<std::array<double, numbers>> beams;
  std::vector<double> limits;  ///< twice the energy a whole beam may hold before its s matters [J]
};
/// State of a run's breakable beams.
struct Damage {
  /// Numbers of a beam's crack (fracture_laws/law.h); kappa 0: it has none.
  enum Number : int {
    kappa,
    damage,
    ultimate,
    mode_mix,
    nominal,
    dissipated,
    at_tip,
    crushed,
    time,
    place,
    numbers = place + 3
  };
  std::vector<double> cracks;  ///< beam after beam; from an engine empty: as it was put
  std::vector<float> viscous;  ///< beam after beam: forces of dashpots at the last step's start
};

/// What an engine needs to list the pairs of a run by itself. Bodies are the engine's.
struct Listing {
  double reach = 0;                                ///< largest gap of a listed pair [m]
  double young = 0, young_broken = 0;              ///< E_c [Pa], that where a beam has broken
  double friction = 0, friction_wet = 0;           ///< mu between bodies, that below still water
  std::vector<double> sizes;                       ///< per body: L [m]
  std::vector<double> widths;                      ///< of bodies, then of obstacles [m]
  std::vector<std::array<double, 2>> frictions;    ///< per obstacle, as above
  std::vector<std::int32_t> ranks;                 ///< per body: its place in the model's order
  std::vector<std::array<std::int32_t, 2>> beams;  ///< the broken ones too
};
/// Which bodies of a run may touch (contact/eligibility.h); changes where a beam breaks.
struct Eligible {
  /// States of a body, in bits.
  enum State : std::uint8_t { on_surface = 1, left_out = 2, large = 4 };
  std::vector<std::int32_t> pieces;                 ///< per body: number of its piece
  std::vector<std::uint8_t> states;                 ///< per body
  std::vector<std::array<std::int32_t, 2>> broken;  ///< beams
};

/// Contacts of a lattice: shapes of its bodies, then of obstacles, and the law (DeviceContacts).
struct Contacts {
  bool potential = false, with_patch = false, wears = false;
  double damping_ratio = 0;
  std::array<double, 7> plastic_limit{};
  std::array<double, 3> periods{};  ///< [m]; 0: none
  double slack = 0;                 ///< [m]
  std::int32_t obstacles = 0;
  // Per solid, and one more: where its vertices and planes begin.
  std::vector<std::int32_t> first_vertex{0}, first_plane{0};
  std::vector<std::array<double, 3>> vertices;
  std::vector<HalfSpace> planes;
  std::vector<std::int32_t> graph;
  std::vector<EdgeGraph> graphs;
  std::vector<double> radius;
  std::vector<std::int32_t> carriers;          ///< per obstacle: the body that carries it, or -1
  std::vector<std::array<double, 4>> inverse;  ///< per body
  std::vector<std::array<double, 3>> rest;     ///< per body: centroid at rest [m]
  std::optional<Listing> listing;
};
/// Pairs that may touch, sorted as bodies sum them; obstacle k of the run is `bodies` + k.
struct Pairs {
  std::vector<std::array<std::int32_t, 2>> solids;
  std::vector<std::array<double, 6>> numbers;    ///< as DevicePairs
  std::vector<std::array<double, 7>> histories;  ///< likewise
  std::vector<std::uint8_t> states;              ///< likewise
  std::vector<std::array<double, 8>> crushes{};  ///< likewise
  Eligible eligible{};  ///< without pieces: an engine does not list the pairs of this run
};
/// A pair that had crushed ice and has parted.
struct Parted {
  std::array<std::int32_t, 2> solids{};
  std::array<double, 8> crush{};
};
/// A plane beyond which a body of the engine has nothing left, in the frame of the body.
struct WornPlane {
  static constexpr std::int32_t most = 8;  ///< of a body
  std::int32_t body = 0;
  HalfSpace left;
};

/// One run's lattice for an engine. Bodies are in the engine's order, in which those of a tile
/// follow each other.
struct Lattice {
  std::int32_t bodies = 0;
  std::vector<std::array<double, 8>> constants;  ///< 1/m, 1/I_1, 1/I_2, 1/I_3, axes w x y z
  std::vector<double> weights;                   ///< along -z [N]; empty: none

  /// Numbers of a beam: triad (9), offsets (6), length, stiffnesses (6), dashpots (6).
  static constexpr std::size_t of_beam = 28;
  std::vector<std::array<std::int32_t, 2>> ends;
  std::vector<std::array<double, of_beam>> beams;
  bool damped = false, flat = true, eccentric = false;

  /// Bodies with prescribed components.
  struct Held {
    std::int32_t body;
    std::uint8_t bits;
    /// Per component: which of the motions at a time it follows; -1: none.
    std::array<std::int32_t, 6> motions;
  };
  std::vector<Held> held;
  std::int32_t motions = 0;

  /// Loads on bodies, in the order in which a body adds them.
  struct Loaded {
    std::int32_t body, load;
    std::array<double, 3> arm;
  };
  std::vector<Loaded> loaded;
  std::int32_t loads = 0;

  /// Springs and dashpots on bodies, one on a body at most (forces/support_law.h).
  struct Supported {
    std::int32_t body;
    std::array<double, 3> arm;
    std::array<double, 36> stiffness, damping;
  };
  std::vector<Supported> supports;

  std::optional<Water> water;
  std::optional<Breaking> breaking;
  bool halts_at_breaks = false;  ///< a run halts at a step in which a beam breaks
  std::optional<Contacts> contacts;
};

/// Steps to be made of one run.
struct Steps {
  int count = 0;
  double dt = 0;                   ///< of each [s]
  double before = 0;               ///< length of the step before the first; 0: there is none [s]
  std::vector<double> motions{};   ///< per step: prescribed values at its start and end [m, rad]
  std::vector<double> wrenches{};  ///< per step and load: force and moment on each body [N, N m]
  std::vector<double> water{};     ///< per step: level [m] and current [m/s] of the water
  std::vector<double> times{};     ///< per step: at its start, where beams break [s]
  std::vector<double> accelerations{};  ///< per step: of prescribed motions, where contacts damp
  std::vector<double> obstacles{};      ///< per step and obstacle, as DeviceContacts::ObstacleStep
  int since = 0;                        ///< steps since all submerged parts were found, at a pace
};

/// The steps that a run has made. Where it halted at one, those after it stood still, so that they
/// can be given again.
struct Made {
  /// Reasons to halt, in bits.
  enum Why : std::uint32_t {
    beam_broke = 1,
    list_expired = 2,  ///< vertices have moved by the slack of the list of pairs
    no_room = 4,       ///< an overlap has more corners than an engine has room for
    parted = 8         ///< a contact that has crushed ice has parted, which wears a body off
  };
  int steps = 0;
  std::uint32_t why = 0;  ///< 0: it did not halt
};
/// What the steps since the last question have done, of one run.
struct Findings {
  double speed2 = 0, spin2 = 0;  ///< largest squares; perhaps not finite [m^2/s^2, rad^2/s^2]
};
/// Works since they were forgotten, of one run, in parts [J].
struct Works {
  std::vector<double> beams;           ///< per body: by dashpots of beams of which it is the first
  std::vector<double> held;            ///< per held body: by boundaries
  std::vector<double> loaded;          ///< per load on a body
  std::vector<double> supports;        ///< per support: by its dashpots
  std::vector<double> drag, buoyancy;  ///< per body; empty: none
  /// By contacts: per body those of elastic, viscous and friction's terms; per obstacle these, and
  /// that of the obstacle.
  std::vector<double> contacts, obstacles;
};

/// Steps several runs at once. Each run's numbers are those that it would have alone, to the last
/// bit, whatever its tiles.
class Engine {
 public:
  static constexpr std::size_t record = 16;  ///< numbers of a body, as Spatial::record

  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  /// Sets, or returns, the records of a run's bodies: body after body.
  virtual void put(std::size_t run, std::span<const double> records) = 0;
  virtual void get(std::size_t run, std::span<double> records) = 0;
  /// Sets, or returns, the submerged parts that a run with a pace keeps: body after body, 15
  /// numbers as Submersion keeps them.
  virtual void put_submerged(std::size_t run, std::span<const double> numbers) = 0;
  virtual void get_submerged(std::size_t run, std::span<double> numbers) = 0;
  /// Sets, or returns, the damage of a run whose beams break.
  virtual void put_damage(std::size_t run, const Damage& damage) = 0;
  virtual Damage get_damage(std::size_t run) = 0;
  /// Sets the pairs of a run at its present state; returns them but for who may touch.
  virtual void put_pairs(std::size_t run, Pairs pairs) = 0;
  virtual void get_pairs(std::size_t run, Pairs& pairs) = 0;
  /// Lists the pairs of a run anew at its present state, which keep their histories. Returns false,
  /// with nothing changed, where there is no room for them or the run's list is not an engine's.
  /// \param obstacles  of each: origin and axes now, 12 numbers
  virtual bool list_pairs(std::size_t run, std::span<const double> obstacles) = 0;
  /// Returns the pairs that have parted in the last step, in order.
  virtual std::vector<Parted> get_parted(std::size_t run) = 0;
  /// Sets all planes of the bodies that these are of.
  virtual void put_worn(std::size_t run, std::span<const WornPlane> planes) = 0;
  /// Sets, or returns, largest forces and impulses of the obstacles of a run, six numbers each.
  virtual void put_obstacles(std::size_t run, std::span<const double> numbers) = 0;
  virtual void get_obstacles(std::size_t run, std::span<double> numbers) = 0;
  /// Makes steps of each run, which may differ in number; returns perhaps before they are made.
  virtual void step(std::span<const Steps> steps) = 0;
  /// Returns what the last step() has made of a run's steps.
  virtual Made made(std::size_t run) = 0;
  virtual Findings findings(std::size_t run) = 0;
  virtual Works works(std::size_t run) = 0;
  /// Sets the works of a run, which steps add to.
  virtual void put_works(std::size_t run, const Works& works) = 0;
  /// Lets the works of a run begin anew.
  virtual void forget_works(std::size_t run) = 0;
  virtual std::int32_t tiles() const = 0;
};

/// \param lattices    one per run
/// \param tile        most bodies of a tile, at most 128; 0: by the number of bodies
std::unique_ptr<Engine> make_loop_engine(std::vector<Lattice> lattices, std::int32_t tile = 0);
/// \throws Failed if there is no device, InputError if floe is built without CUDA
std::unique_ptr<Engine> make_cuda_engine(std::vector<Lattice> lattices, std::int32_t tile = 0);
/// The same without fused operations, for tests: with the bits of make_loop_engine(). Not part of
/// the library.
std::unique_ptr<Engine> make_exact_cuda_engine(std::vector<Lattice> lattices,
                                               std::int32_t tile = 0);
/// Whether floe is built with CUDA.
bool has_cuda();
/// Returns the name of the device that an engine would take; empty: there is none.
std::string name_of_device();

}  // namespace floe::device
