/// \file
/// Leapfrog on a back end that keeps the state: what joins an engine and a model.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/engine.h"
#include "model/model.h"

namespace floe::device {

/// A model in the form of an engine.
struct DescribedModel {
  Lattice lattice;
  std::vector<std::int32_t> order;  ///< per body of the engine: the body of the part
  DeviceModel numbers;              ///< of the forces
};
/// \param backend  its name, for messages
/// \throws InputError for what no engine can compute yet, with its name
DescribedModel describe(const Model<Spatial>& model, const std::string& backend);

/// Steps the bodies of a model on an engine. The state lies there; it is handed over and brought
/// back where somebody looks at it. Steps are queued and made many at once.
class DeviceStepper {
 public:
  /// \param model  must outlive this object
  DeviceStepper(const Model<Spatial>& model, DescribedModel described,
                std::unique_ptr<Engine> engine);

  /// Works of a run until put(), and since, part by part. Sums of them do not depend on how often
  /// somebody asks; a checkpoint keeps the parts, so that they do not depend on restarts.
  struct WorkParts {
    std::vector<double> until;  ///< of all forces [J]
    double boundaries = 0;      ///< until then [J]
    Works since;
  };
  /// Hands the records to the engine.
  void put(const State<Spatial>& state, const WorkParts& works);
  /// Copies the records; nothing may be queued. Times of the state are the caller's.
  void get(State<Spatial>& state);
  /// Queues a step. \param time  of its start [s] \param before  length of the step before it [s]
  void queue(double time, double dt, double before);
  /// Makes the queued steps. Returns the square of the largest speed in them [m^2/s^2].
  double flush();
  /// Sets the works of all forces [J]. Returns that of the boundaries [J].
  double take_works(std::span<double> works);
  /// The parts of what take_works() found last, and the sums of such parts as take_works() gives
  /// them; nothing if the parts are not those of this model.
  const WorkParts& work_parts() const { return works_; }
  std::optional<double> sum(const WorkParts& parts, std::span<double> works) const;
  /// Largest speed and spin of the steps of the last flush [m/s, rad/s].
  double fastest() const { return fastest_; }
  double fastest_spin() const { return fastest_spin_; }

  const Engine& engine() const { return *engine_; }

 private:
  static constexpr std::size_t of_kept = 15;  ///< numbers of a submerged part
  /// What keeps submerged parts on the processor; null: nothing does.
  KeptParts* kept_parts() const {
    const auto& water = described_.numbers.water;
    return water ? water->kept : nullptr;
  }

  void drop(int count);

  const Model<Spatial>& model_;
  DescribedModel described_;
  std::unique_ptr<Engine> engine_;
  Steps steps_;
  std::vector<double> room_, kept_;
  WorkParts works_;
  std::int64_t since_ = 0;  ///< steps since all submerged parts were found
  double fastest_ = 0, fastest_spin_ = 0;
  double last_dt_ = 0;  ///< of the last step that was queued [s]
};

}  // namespace floe::device
