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
  std::vector<std::int32_t> place;  ///< per body of the part: that of the engine
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

  /// KeptContacts::are_possible() and watches(); without contacts true and false.
  bool contacts_are_possible() const {
    const auto& contacts = described_.numbers.contacts;
    return !contacts || contacts->kept->are_possible();
  }
  bool watches() const {
    const auto& contacts = described_.numbers.contacts;
    return contacts && contacts->kept->watches();
  }

  const Engine& engine() const { return *engine_; }

 private:
  static constexpr std::size_t of_kept = 15;  ///< numbers of a submerged part
  /// What keeps submerged parts on the processor; null: nothing does.
  KeptParts* kept_parts() const {
    const auto& water = described_.numbers.water;
    return water ? water->kept : nullptr;
  }

  void get_records(State<Spatial>& state);
  void list_pairs(const State<Spatial>& state);
  void keep_contacts();
  void get_pairs();
  std::int32_t body_or_obstacle(std::int32_t solid) const;
  void put_worn(const std::vector<floe::WornPlane>& planes);
  void wear_bodies();
  Eligible eligible() const;
  void renew_pairs(double time, bool broke);
  bool list_on_engine(double time);
  void release_broken();
  void note_broken(std::span<const double> cracks, std::vector<std::array<std::int32_t, 2>>& fresh);
  void queue_contacts(const DeviceContacts& contacts, double time, double dt, double before);
  void make_steps();
  void drop(int count);

  const Model<Spatial>& model_;
  DescribedModel described_;
  std::unique_ptr<Engine> engine_;
  Steps steps_;
  std::vector<double> room_, kept_;
  WorkParts works_;
  std::int64_t since_ = 0;  ///< steps since all submerged parts were found
  double fastest_ = 0, fastest_spin_ = 0;
  double last_dt_ = 0;                ///< of the last step that was queued [s]
  std::vector<double> times_;         ///< of the queued steps [s]
  std::int64_t made_ = 0;             ///< steps made since then
  DevicePairs pairs_;                 ///< as they were listed
  State<Spatial> listed_;             ///< work space of renew_pairs()
  std::vector<std::uint8_t> broken_;  ///< per beam, where a break releases a pair
  double listed_at_ = 0;              ///< time of the list [s]
  std::int64_t steps_of_list_ = 0;    ///< made since contacts were kept
};

}  // namespace floe::device
