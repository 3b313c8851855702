// floe._floe: the library of floe for the Python package floe, which has the documented interface.
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "arrays.h"
#include "floe/base/petsc.h"
#include "floe/files/progress.h"
#include "floe/options/options.h"
#include "floe/scene/keys.h"
#include "floe/scene/restart.h"
#include "floe/session/command_line.h"
#include "floe/session/version.h"
#include "runtime.h"

namespace floe::python {
namespace {

using namespace pybind11::literals;

/// An object of Python that may be copied and dropped without its lock.
using Kept = std::shared_ptr<py::object>;
Kept keep(py::object object) {
  return {new py::object(std::move(object)), [](py::object* kept) {
            const py::gil_scoped_acquire lock;
            delete kept;
          }};
}

/// A scene that was read, with its options of PETSc.
struct ReadScene {
  Scene scene;
  std::shared_ptr<SolverOptions> options;
};

/// \param path   of the scene's file, or the name of a text
/// \param text   of the scene; none: the file is read
/// \param words  options as on the command line
ReadScene read(const std::string& path, const std::optional<std::string>& text,
               const std::vector<std::string>& words) {
  start();
  std::vector<const char*> all{"floe", path.c_str()};
  for (const std::string& word : words) all.push_back(word.c_str());
  const CommandLine line = read_command_line(static_cast<int>(all.size()), all.data());
  UserOptions options = text ? options_of_text(line, path, *text) : options_of(line);
  const Restart restart = find_restart(path, options);
  ReadScene read{.scene = {}, .options = std::make_shared<SolverOptions>(options)};
  const SolverOptions::Use use(*read.options);
  read.scene = read_scene(restart.scene, options);
  constexpr double rounding = 1e-12;
  if (!restart.done_in.empty() && read.scene.time.end <= (1 + rounding) * restart.done_end)
    throw InputError("checkpoint: restart: the run in " + restart.done_in + " is done already");
  for (const std::string& remark : restart.remarks) read.scene.remarks.push_back(remark);
  return read;
}

/// A signal's exception that a handler of Python has raised during a call of the library.
std::optional<py::error_already_set>& interrupt() {
  static std::optional<py::error_already_set> error;
  return error;
}

bool was_interrupted() {
  const py::gil_scoped_acquire lock;
  if (!interrupt() && PyErr_CheckSignals() != 0) interrupt().emplace();
  return interrupt().has_value();
}

/// A simulation of Python. All methods but destruction are collective.
class Run {
 public:
  Run(const ReadScene& read, const std::vector<std::string>& coupled, const py::list& forces,
      bool talks, bool progress, bool check)
      : progress_(progress) {
    start();
    free_dropped();
    SimulationSettings settings{.talks = talks, .goes_back = !check, .coupled = coupled};
    for (const py::handle& force : forces) settings.forces.push_back(force_of(force));
    settings.wants_pause = was_interrupted;
    Scene scene = read.scene;
    if (check) scene.check_only = true;
    Held held{.options = read.options, .simulation = {}};
    {
      const SolverOptions::Use use(*held.options);
      const Quiet quiet(progress_);
      const py::gil_scoped_release release;
      held.simulation = std::make_unique<Simulation>(std::move(scene), settings);
    }
    owner_ = std::make_unique<Owner>(std::move(held));
  }

  /// Does work with the simulation. \param releases  whether Python goes on meanwhile
  template <class Work>
  auto with(Work&& work, bool releases = false) {
    Held* held = owner_->get();
    if (held == nullptr) throw py::value_error("the simulation is closed");
    const SolverOptions::Use use(*held->options);
    const Quiet quiet(progress_);
    if (!releases) return work(*held->simulation);
    const py::gil_scoped_release release;
    return work(*held->simulation);
  }

  bool step_to(double time) {
    free_dropped();
    bool goes_on = false;
    std::exception_ptr why;
    try {
      goes_on = with([&](Simulation& s) { return s.step_to(time); }, true);
    } catch (const CallbackFailed& error) {
      if (!error.why()) throw;
      why = error.why();
    }
    if (why) std::rethrow_exception(why);
    raise_interrupt();
    return goes_on;
  }
  bool is_open() { return owner_->get() != nullptr; }
  void close() {
    owner_->free();
    free_dropped();
  }

 private:
  /// Raises the exception of a signal's handler on its rank, and KeyboardInterrupt on all others.
  static void raise_interrupt() {
    int came = interrupt() ? 1 : 0;
    if (size() > 1)
      floe::check(MPI_Allreduce(MPI_IN_PLACE, &came, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD));
    if (came == 0) return;
    if (auto mine = std::exchange(interrupt(), std::nullopt)) throw std::move(*mine);
    PyErr_SetString(PyExc_KeyboardInterrupt, "another rank was interrupted");
    throw py::error_already_set();
  }
  struct Quiet {
    explicit Quiet(bool progress) { show_progress(progress); }
    ~Quiet() { show_progress(true); }
  };
  static BodyForce force_of(const py::handle& force) {
    const Kept add = keep(force.attr("add"));
    BodyForce of_library;
    of_library.set = [add](const std::shared_ptr<BodyArrays>& bodies) {
      const py::gil_scoped_acquire lock;
      (*add)(bodies);
    };
    of_library.stiffness = force.attr("stiffness").cast<double>();
    of_library.damping = force.attr("damping").cast<double>();
    return of_library;
  }

  std::unique_ptr<Owner> owner_;
  bool progress_;
};

py::dict as_dict(const std::vector<std::pair<std::string, double>>& columns) {
  py::dict all;
  for (const auto& [name, value] : columns) all[py::str(name)] = value;
  return all;
}

py::dict as_dict(const RunResult& result) {
  return py::dict("done"_a = result.done, "stopped"_a = result.stopped,
                  "message"_a = result.message, "steps"_a = result.steps, "dt"_a = result.dt,
                  "stable_dt"_a = result.stable_dt, "limited_by"_a = result.limited_by,
                  "warnings"_a = result.warnings);
}

py::dict as_dict(const ObstacleNow& o) {
  return py::dict("body"_a = o.body, "coupled"_a = o.coupled, "position"_a = array_of(o.position),
                  "orientation"_a = array_of(o.orientation), "velocity"_a = array_of(o.velocity),
                  "spin"_a = array_of(o.spin), "force"_a = array_of(o.force),
                  "moment"_a = array_of(o.moment), "impulse"_a = array_of(o.impulse));
}

using Three = std::array<double, 3>;
Vec3<double> vector(const Three& v) { return {v[0], v[1], v[2]}; }

const char* name_of(Kind kind) {
  constexpr std::array names{"flag",   "number",  "duration", "integer", "numbers",
                             "choice", "choices", "names",    "text"};
  return names[static_cast<std::size_t>(kind)];
}

py::list options_table() {
  py::list all;
  for (const OptionSpec& line : scene_keys())
    all.append(py::make_tuple(std::string(line.key), name_of(line.kind), std::string(line.unit),
                              std::string(line.fallback), std::string(line.allowed),
                              std::string(line.doc), line.count));
  return all;
}

/// Exceptions of the package: InputError, CallbackError, RunFailed.
void register_errors() {
  const auto errors = py::module_::import("floe.errors"),
             failures = py::module_::import("floe.failures");
  static const auto* const all = new std::array<py::object, 3>{
      errors.attr("InputError"), failures.attr("CallbackError"), failures.attr("RunFailed")};
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 wants it by value
  py::register_exception_translator([](std::exception_ptr error) {
    const auto raise = [](std::size_t type, const std::exception& why) {
      PyErr_SetString((*all)[type].ptr(), why.what());
    };
    try {
      if (error) std::rethrow_exception(error);
    } catch (const InputError& why) {
      raise(0, why);
    } catch (const CallbackFailed& why) {
      // The rank that has an exception of its own gets it, whatever asked for the forces.
      if (why.why()) std::rethrow_exception(why.why());
      raise(1, why);
    } catch (const Verdict& why) {
      raise(2, why);
    }
  });
}

template <auto member>
py::array member_of(const py::object& self) {
  return view(self.cast<BodyArrays&>().*member, self);
}
template <auto member>
py::array writable_member_of(const py::object& self) {
  return view(self.cast<BodyArrays&>().*member, self, true);
}

void define_bodies(py::module_& m) {
  using Class = py::class_<BodyArrays, std::shared_ptr<BodyArrays>>;
  Class(m, "ForceBodies")
      .def_readonly("time", &BodyArrays::time)
      .def_property_readonly("index", member_of<&BodyArrays::index>)
      .def_property_readonly("position", member_of<&BodyArrays::position>)
      .def_property_readonly("orientation", member_of<&BodyArrays::orientation>)
      .def_property_readonly("velocity", member_of<&BodyArrays::velocity>)
      .def_property_readonly("spin", member_of<&BodyArrays::spin>)
      .def_property_readonly("mass", member_of<&BodyArrays::mass>)
      .def_property("force", writable_member_of<&BodyArrays::force>,
                    [](const py::object& self, const py::object& value) {
                      self.attr("force")[py::ellipsis()] = value;
                    })
      .def_property("moment", writable_member_of<&BodyArrays::moment>,
                    [](const py::object& self, const py::object& value) {
                      self.attr("moment")[py::ellipsis()] = value;
                    })
      .def("__len__", [](const BodyArrays& bodies) { return bodies.index.size(); });
}

void define_scene(py::module_& m) {
  py::class_<ReadScene>(m, "Scene")
      .def(py::init(&read), "path"_a, "text"_a, "words"_a)
      .def_property_readonly("name", [](const ReadScene& r) { return r.scene.name; })
      .def_property_readonly("end", [](const ReadScene& r) { return r.scene.time.end; })
      .def_property_readonly("output", [](const ReadScene& r) { return r.scene.output.dir; })
      .def_property_readonly("yaml", [](const ReadScene& r) { return r.scene.options_yaml; })
      .def_property_readonly("remarks", [](const ReadScene& r) { return r.scene.remarks; })
      .def_property_readonly("warnings", [](const ReadScene& r) { return r.scene.warnings; })
      .def_property_readonly("obstacles", [](const ReadScene& r) {
        std::vector<std::string> names;
        names.reserve(r.scene.obstacles.size());
        for (const Obstacle& obstacle : r.scene.obstacles) names.push_back(obstacle.name);
        return names;
      });
}

void define_run(py::module_& m) {
  const py::class_<SavedState, std::shared_ptr<SavedState>> state(m, "State");
  py::class_<Run>(m, "Run")
      .def(py::init<const ReadScene&, const std::vector<std::string>&, const py::list&, bool, bool,
                    bool>(),
           "scene"_a, "coupled"_a, "forces"_a, "talks"_a, "progress"_a, "check"_a)
      .def("prepare",
           [](Run& r) { return r.with([](Simulation& s) { return s.prepare(); }, true); })
      .def("step_to", &Run::step_to)
      .def("is_open", &Run::is_open)
      .def("close", &Run::close)
      .def("time", [](Run& r) { return r.with([](Simulation& s) { return s.time(); }); })
      .def("dt", [](Run& r) { return r.with([](Simulation& s) { return s.dt(); }); })
      .def("end", [](Run& r) { return r.with([](Simulation& s) { return s.scene().time.end; }); })
      .def("has_ended", [](Run& r) { return r.with([](Simulation& s) { return s.has_ended(); }); })
      .def("outcome",
           [](Run& r) { return r.with([](Simulation& s) { return as_dict(s.outcome()); }); })
      .def("results",
           [](Run& r) {
             return r.with([](Simulation& s) {
               const Results& results = s.results();
               return py::make_tuple(results.summary_json, results.text);
             });
           })
      .def("bodies",
           [](Run& r) {
             BodyTable t = r.with([](Simulation& s) { return s.all_bodies(); });
             return py::make_tuple(array_of(std::move(t.index)), array_of(std::move(t.position)),
                                   array_of(std::move(t.orientation)),
                                   array_of(std::move(t.velocity)), array_of(std::move(t.spin)),
                                   array_of(std::move(t.mass)), array_of(std::move(t.fragment)));
           })
      .def("beams",
           [](Run& r) {
             BeamTable t = r.with([](Simulation& s) { return s.beams(); });
             return py::make_tuple(array_of(std::move(t.bodies)), array_of(std::move(t.section)),
                                   array_of(std::move(t.damage)));
           })
      .def("contacts",
           [](Run& r) {
             const auto all = r.with([](Simulation& s) { return s.contacts(); });
             std::vector<std::array<std::int32_t, 2>> bodies;
             std::vector<std::int32_t> obstacle;
             std::vector<Vec3<double>> force, point, normal;
             std::vector<double> volume, area;
             for (const ContactOfPair& c : all) {
               bodies.push_back({c.a, c.b});
               obstacle.push_back(c.obstacle);
               force.push_back(c.force), point.push_back(c.point), normal.push_back(c.normal);
               volume.push_back(c.volume), area.push_back(c.area);
             }
             return py::make_tuple(array_of(std::move(bodies)), array_of(std::move(obstacle)),
                                   array_of(std::move(force)), array_of(std::move(point)),
                                   array_of(std::move(normal)), array_of(std::move(volume)),
                                   array_of(std::move(area)));
           })
      .def("columns",
           [](Run& r) { return r.with([](Simulation& s) { return as_dict(s.columns()); }); })
      .def("obstacle_names",
           [](Run& r) { return r.with([](Simulation& s) { return s.obstacle_names(); }); })
      .def("obstacles",
           [](Run& r) {
             py::dict all;
             for (const ObstacleNow& o : r.with([](Simulation& s) { return s.obstacles(); }))
               all[py::str(o.name)] = as_dict(o);
             return all;
           })
      .def(
          "prescribe",
          [](Run& r, const std::string& name, const Three& position, const std::array<double, 4>& q,
             const Three& velocity, const Three& spin, std::optional<double> until) {
            const PlaceAndMotion to{.position = vector(position),
                                    .orientation = {q[0], q[1], q[2], q[3]},
                                    .velocity = vector(velocity),
                                    .spin = vector(spin)};
            r.with([&](Simulation& s) { s.prescribe(name, to, until); });
          })
      .def("apply",
           [](Run& r, const std::string& name, const Three& force, const Three& moment) {
             r.with([&](Simulation& s) { s.apply(name, vector(force), vector(moment)); });
           })
      .def("save",
           [](Run& r) {
             return std::const_pointer_cast<SavedState>(
                 r.with([](Simulation& s) { return s.save(); }));
           })
      .def("restore", [](Run& r, const SavedState& state) {
        r.with([&](Simulation& s) { s.restore(state); });
      });
}

}  // namespace
}  // namespace floe::python

PYBIND11_MODULE(_floe, m) {
  using namespace floe::python;
  register_errors();
  define_bodies(m);
  define_scene(m);
  define_run(m);
  m.def("options", &options_table);
  m.def("version", &floe::version);
  m.def("version_text", &floe::version_text);
  m.def("start", &start);
  m.def("finish", &finish);
  m.def("alive", &alive);
  m.def("rank", [] {
    start();
    return floe::rank();
  });
  m.def("size", [] {
    start();
    return floe::size();
  });
  m.def("abort", [](int code) { MPI_Abort(MPI_COMM_WORLD, code); });
}
