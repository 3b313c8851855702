/// \file
/// Contacts in the memory of an engine.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "device/contact_step.h"
#include "device/engine.h"
#include "device/launch.h"
#include "device/pair_lister.h"
#include "forces/device_contacts.h"

namespace floe::device {
namespace {  // of each back end its own, as in launch.h

/// The contacts of all runs of an engine. Each run has room for its pairs, in whole blocks.
class ContactStore {
 public:
  /// \param first_body  per run, and one more
  void take(const std::vector<Lattice>& lattices, const std::vector<std::int32_t>& first_body) {
    if (std::none_of(lattices.begin(), lattices.end(),
                     [](const Lattice& lattice) { return lattice.contacts.has_value(); }))
      return;
    first_body_ = first_body;
    bodies_ = static_cast<std::size_t>(first_body.back());
    std::vector<std::int32_t> run_of_obstacle, carriers;
    for (std::size_t r = 0; r < lattices.size(); ++r) {
      const std::int32_t obstacles = lattices[r].contacts ? lattices[r].contacts->obstacles : 0;
      first_obstacle_.push_back(first_obstacle_.back() + obstacles);
      run_of_obstacle.insert(run_of_obstacle.end(), static_cast<std::size_t>(obstacles),
                             static_cast<std::int32_t>(r));
      for (std::int32_t k = 0; k < obstacles; ++k) {
        const std::int32_t body = lattices[r].contacts->carriers[static_cast<std::size_t>(k)];
        carriers.push_back(body < 0 ? -1 : first_body[r] + body);
      }
      runs_.push_back(run_of(lattices[r], r));
      damps_ = damps_ || runs_.back().damps != 0;
      wears_ = wears_ || runs_.back().wears != 0;
    }
    take_solids(lattices);
    pairs_.resize(runs_.size());
    room_.assign(runs_.size(), 0);
    runs_here_ = Array<ContactsOfRun>(runs_.size());
    run_of_obstacle_ = keep(run_of_obstacle);
    carriers_here_ = keep(carriers);
    carriers_ = std::move(carriers);
    first_of_obstacle_ = Array<std::int32_t>(obstacles());
    count_of_obstacle_ = Array<std::int32_t>(obstacles());
    obstacle_forces_ = Array<double>(6 * obstacles());
    obstacle_works_ = Array<double>(4 * obstacles());
    first_end_ = Array<std::int32_t>(bodies_);
    end_count_ = Array<std::int32_t>(bodies_);
    listed_ = Array<double>(of_listed * bodies_);
    others_ = Array<double>(6 * bodies_);
    predicted_ = Array<double>(6 * bodies_);
    works_ = Array<double>(3 * bodies_);
    lister_.take(lattices, first_body_, first_obstacle_);
    if (!wears_) return;
    worn_ = Array<HalfSpace>(WornPlane::most * bodies_);
    worn_planes_ = Array<std::int32_t>(bodies_);
  }

  bool any() const { return !runs_.empty(); }
  bool damps() const { return damps_; }
  std::size_t obstacles() const { return static_cast<std::size_t>(first_obstacle_.back()); }
  /// Numbers of pairs and of blocks of them that there is room for.
  std::int32_t room() const { return static_cast<std::int32_t>(a_.size()); }
  std::int32_t blocks() const { return room() / of_block; }

  /// Sets the pairs of a run, and notes where its bodies are. Returns whether memory has moved.
  bool put_pairs(std::size_t run, Pairs pairs, const Array<double>& records) {
    keep_places(run, records);
    runs_[run].pairs = static_cast<std::int64_t>(pairs.solids.size());
    const bool moves = pairs.solids.size() > room_[run];
    if (moves) {
      for (std::size_t r = 0; r < runs_.size(); ++r)
        if (r != run && room_[r] > 0) get_pairs(r, pairs_[r]);
      const std::size_t wanted = pairs.solids.size() + pairs.solids.size() / 2;
      room_[run] = (wanted / of_block + 1) * of_block;
    }
    pairs_[run] = std::move(pairs);
    lister_.put(run, pairs_[run].eligible);
    if (moves) make_room();
    for (std::size_t r = 0; r < runs_.size(); ++r)
      if (r == run || (moves && room_[r] > 0)) upload(r);
    return moves;
  }
  /// Lists the pairs of a run anew. Returns whether there was room for them.
  /// \param obstacles  of each: origin and axes now \param bodies  their constants
  bool list_pairs(std::size_t run, std::span<const double> obstacles, Array<double>& records,
                  const Soa& bodies, Queue& queue) {
    if (!lister_.is_ready(run) || room_[run] == 0) return false;
    runs_here_.put(runs_);
    ListMemory m{};
    m.contacts = memory();
    m.records = {records.data(), static_cast<std::int64_t>(bodies_)};
    m.bodies = bodies;
    m.of_a = a_.data(), m.of_b = b_.data();
    m.first_end = first_end_.data(), m.end_count = end_count_.data(), m.ends = ends_.data();
    m.first_of_obstacle = first_of_obstacle_.data();
    m.count_of_obstacle = count_of_obstacle_.data();
    m.pairs_of_obstacle = pairs_of_obstacle_.data();
    const std::int32_t number = lister_.make(run, room_[run], obstacles, m, queue);
    if (number < 0) return false;
    lister_.take_over(m, number, runs_[run].first_pair, queue);
    runs_[run].pairs = number;
    keep_places(run, records);
    return true;
  }
  /// Sets all but who may touch as it is now.
  void get_pairs(std::size_t run, Pairs& pairs) const {
    const auto first = static_cast<std::size_t>(runs_[run].first_pair);
    std::vector<double> row(static_cast<std::size_t>(runs_[run].pairs));
    pairs.solids.resize(row.size());
    pairs.numbers.resize(row.size());
    pairs.histories.resize(row.size());
    pairs.states.resize(row.size());
    if (row.empty()) return;
    get_solids(run, pairs);
    for (std::size_t n = 0; n < of_constants; ++n) {
      constants_.get(row, n * a_.size() + first);
      for (std::size_t k = 0; k < row.size(); ++k) pairs.numbers[k][n] = row[k];
    }
    for (std::size_t n = 0; n < of_history; ++n) {
      history_.get(row, n * a_.size() + first);
      for (std::size_t k = 0; k < row.size(); ++k) pairs.histories[k][n] = row[k];
    }
    states_.get(pairs.states, first);
    if (runs_[run].wears == 0) return;
    pairs.crushes.resize(row.size());
    for (std::size_t n = 0; n < DevicePairs::crush; ++n) {
      crushes_.get(row, n * a_.size() + first);
      for (std::size_t k = 0; k < row.size(); ++k) pairs.crushes[k][n] = row[k];
    }
  }
  /// Returns the pairs that have parted in the last step: few of many.
  std::vector<Parted> get_parted(std::size_t run) const {
    std::vector<Parted> all;
    if (runs_[run].wears == 0) return all;
    const auto first = static_cast<std::size_t>(runs_[run].first_pair);
    std::vector<std::uint8_t> states(static_cast<std::size_t>(runs_[run].pairs));
    states_.get(states, first);
    for (std::size_t k = 0; k < states.size(); ++k) {
      if ((states[k] & DevicePairs::parted) == 0) continue;
      std::array<std::int32_t, 1> a{}, b{};
      a_.get(a, first + k);
      b_.get(b, first + k);
      Parted& parted = all.emplace_back();
      parted.solids = {a[0] - first_body_[run], of_run(run, b[0])};
      for (std::size_t n = 0; n < parted.crush.size(); ++n)
        crushes_.get(std::span(&parted.crush[n], 1), n * a_.size() + first + k);
    }
    return all;
  }
  /// Sets all planes of the bodies that these are of.
  void put_worn(std::size_t run, std::span<const WornPlane> planes) {
    for (std::size_t k = 0; k < planes.size();) {
      const std::int32_t body = planes[k].body;
      std::vector<HalfSpace> left;
      for (; k < planes.size() && planes[k].body == body; ++k) left.push_back(planes[k].left);
      if (left.size() > WornPlane::most) throw Failed("a body has too many planes of wear");
      const auto at = static_cast<std::size_t>(first_body_[run] + body);
      worn_.put(left, WornPlane::most * at);
      worn_planes_.put(std::vector<std::int32_t>{static_cast<std::int32_t>(left.size())}, at);
    }
  }
  void put_obstacles(std::size_t run, std::span<const double> numbers) {
    obstacle_forces_.put(numbers, 6 * static_cast<std::size_t>(first_obstacle_[run]));
  }
  void get_obstacles(std::size_t run, std::span<double> numbers) const {
    obstacle_forces_.get(numbers, 6 * static_cast<std::size_t>(first_obstacle_[run]));
  }

  /// Hands over the tables of steps. Returns whether memory has moved.
  bool put_steps(std::span<const Steps> steps) {
    std::vector<double> motions, accelerations;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      runs_[r].obstacles = static_cast<std::int64_t>(motions.size());
      runs_[r].accelerations = static_cast<std::int64_t>(accelerations.size());
      motions.insert(motions.end(), steps[r].obstacles.begin(), steps[r].obstacles.end());
      accelerations.insert(accelerations.end(), steps[r].accelerations.begin(),
                           steps[r].accelerations.end());
    }
    runs_here_.put(runs_);
    const bool grown = give(motions, motions_);
    return give(accelerations, accelerations_) || grown;
  }

  void add_works(std::size_t run, Works& works) const {
    if (runs_.empty() || runs_[run].any == 0) return;
    const std::size_t bodies = bodies_of(run);
    std::vector<double> row(bodies);
    works.contacts.resize(3 * bodies);
    for (std::size_t n = 0; n < 3; ++n) {
      works_.get(row, n * bodies_ + static_cast<std::size_t>(first_body_[run]));
      for (std::size_t b = 0; b < bodies; ++b) works.contacts[3 * b + n] = row[b];
    }
    works.obstacles.resize(4 * obstacles_of(run));
    obstacle_works_.get(works.obstacles, 4 * static_cast<std::size_t>(first_obstacle_[run]));
  }
  void put_works(std::size_t run, const Works& works) {
    const std::size_t bodies = bodies_of(run);
    if (runs_.empty() || works.contacts.size() != 3 * bodies) return;
    std::vector<double> row(bodies);
    for (std::size_t n = 0; n < 3; ++n) {
      for (std::size_t b = 0; b < bodies; ++b) row[b] = works.contacts[3 * b + n];
      works_.put(row, n * bodies_ + static_cast<std::size_t>(first_body_[run]));
    }
    obstacle_works_.put(works.obstacles, 4 * static_cast<std::size_t>(first_obstacle_[run]));
  }
  void forget_works(std::size_t run) {
    if (runs_.empty()) return;
    for (std::size_t n = 0; n < 3; ++n)
      works_.put(std::vector<double>(bodies_of(run)),
                 n * bodies_ + static_cast<std::size_t>(first_body_[run]));
    obstacle_works_.put(std::vector<double>(4 * obstacles_of(run)),
                        4 * static_cast<std::size_t>(first_obstacle_[run]));
  }

  ContactMemory memory() {
    const auto bodies = static_cast<std::int64_t>(bodies_), room = std::int64_t{this->room()};
    return {runs_here_.data(),
            static_cast<std::int32_t>(bodies_),
            first_vertex_.data(),
            first_plane_.data(),
            vertices_.data(),
            planes_.data(),
            graph_.data(),
            graphs_.data(),
            radius_.data(),
            worn_.data(),
            worn_planes_.data(),
            {rest_.data(), bodies},
            {inverse_.data(), bodies},
            {listed_.data(), bodies},
            {others_.size() == 0 ? nullptr : others_.data(), bodies},
            {predicted_.data(), bodies},
            {works_.data(), bodies},
            first_end_.data(),
            end_count_.data(),
            ends_.data(),
            motions_.data(),
            run_of_obstacle_.data(),
            carriers_here_.data(),
            first_of_obstacle_.data(),
            count_of_obstacle_.data(),
            pairs_of_obstacle_.data(),
            obstacle_forces_.data(),
            obstacle_works_.data(),
            run_of_block_.data(),
            a_.data(),
            b_.data(),
            {constants_.data(), room},
            face_.data(),
            states_.data(),
            touch_.data(),
            {met_.data(), room},
            {history_.data(), room},
            {trials_.data(), room},
            {sums_.data(), room},
            {terms_.data(), room},
            {crushes_.data(), room},
            accelerations_.data()};
  }

 private:
  static constexpr std::size_t of_listed = 7;  ///< displacement and rotation of a record

  template <class T>
  static Array<T> keep(const std::vector<T>& values) {
    return Array<T>(std::span<const T>(values));
  }
  static bool give(const std::vector<double>& values, Array<double>& memory) {
    const bool larger = values.size() > memory.size();
    if (larger) memory = Array<double>(2 * values.size());
    memory.put(values);
    return larger;
  }
  std::size_t bodies_of(std::size_t run) const {
    return static_cast<std::size_t>(first_body_[run + 1] - first_body_[run]);
  }
  std::size_t obstacles_of(std::size_t run) const {
    return static_cast<std::size_t>(first_obstacle_[run + 1] - first_obstacle_[run]);
  }

  /// The body of a run that carries an obstacle, or -1. \param solid  as in Pairs
  std::int32_t carrier(std::size_t run, std::int32_t solid) const {
    const auto k = static_cast<std::size_t>(solid) - bodies_of(run);
    const std::int32_t body = carriers_[static_cast<std::size_t>(first_obstacle_[run]) + k];
    return body < 0 ? -1 : body - first_body_[run];
  }
  ContactsOfRun run_of(const Lattice& lattice, std::size_t run) const {
    ContactsOfRun of{};
    of.first_obstacle = first_obstacle_[run];
    if (!lattice.contacts) return of;
    const Contacts& c = *lattice.contacts;
    of.any = 1;
    of.obstacle_count = c.obstacles;
    of.potential = c.potential ? 1 : 0;
    of.damps = c.damping_ratio > 0 ? 1 : 0;
    of.with_patch = c.with_patch ? 1 : 0;
    of.wears = c.wears ? 1 : 0;
    of.constants.damping_ratio = c.damping_ratio;
    const auto [pressure, area, exponent, least, most, fast, speed] = c.plastic_limit;
    of.constants.plastic_limit = {pressure, area, exponent, least, most, fast, speed};
    of.periods.length = {c.periods[0], c.periods[1], c.periods[2]};
    of.slack = c.slack;
    return of;
  }

  /// Shapes of the bodies of all runs, then of their obstacles. Bodies of runs without contacts
  /// have no shape.
  void take_solids(const std::vector<Lattice>& lattices) {
    std::vector<std::int32_t> first_vertex{0}, first_plane{0}, graph;
    std::vector<double> vertices, radius, rest(3 * bodies_), inverse(4 * bodies_);
    std::vector<HalfSpace> planes;
    std::vector<EdgeGraph> graphs;
    const auto add = [&](const Contacts& c, std::size_t solid, std::size_t graphs_before) {
      for (std::int32_t v = c.first_vertex[solid]; v < c.first_vertex[solid + 1]; ++v) {
        const auto& x = c.vertices[static_cast<std::size_t>(v)];
        vertices.insert(vertices.end(), x.begin(), x.end());
      }
      planes.insert(planes.end(), c.planes.begin() + c.first_plane[solid],
                    c.planes.begin() + c.first_plane[solid + 1]);
      const std::int32_t of = c.graph[solid];
      graph.push_back(of < 0 ? -1 : of + static_cast<std::int32_t>(graphs_before));
      radius.push_back(c.radius[solid]);
    };
    const auto end = [&] {
      first_vertex.push_back(static_cast<std::int32_t>(vertices.size() / 3));
      first_plane.push_back(static_cast<std::int32_t>(planes.size()));
    };
    for (std::size_t r = 0; r < lattices.size(); ++r) {
      const std::size_t graphs_before = graphs.size();
      const auto& of = lattices[r].contacts;
      if (of) graphs.insert(graphs.end(), of->graphs.begin(), of->graphs.end());
      for (std::size_t b = 0; b < bodies_of(r); ++b) {
        const std::size_t at = static_cast<std::size_t>(first_body_[r]) + b;
        if (of) {
          add(*of, b, graphs_before);
          for (std::size_t n = 0; n < 3; ++n) rest[n * bodies_ + at] = of->rest[b][n];
          for (std::size_t n = 0; n < 4; ++n) inverse[n * bodies_ + at] = of->inverse[b][n];
        } else {
          graph.push_back(-1), radius.push_back(0);
        }
        end();
      }
    }
    for (std::size_t r = 0; r < lattices.size(); ++r) {
      for (std::size_t k = 0; k < obstacles_of(r); ++k) {
        add(*lattices[r].contacts, bodies_of(r) + k, 0);
        end();
      }
    }
    first_vertex_ = keep(first_vertex), first_plane_ = keep(first_plane);
    vertices_ = keep(vertices), planes_ = keep(planes);
    graph_ = keep(graph), graphs_ = keep(graphs);
    radius_ = keep(radius), rest_ = keep(rest), inverse_ = keep(inverse);
  }

  /// Makes memory for the room of all runs.
  void make_room() {
    std::vector<std::int32_t> run_of_block;
    std::size_t all = 0;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      runs_[r].first_pair = static_cast<std::int64_t>(all);
      all += room_[r];
      run_of_block.insert(run_of_block.end(), room_[r] / of_block, static_cast<std::int32_t>(r));
    }
    run_of_block_ = keep(run_of_block);
    a_ = Array<std::int32_t>(all), b_ = Array<std::int32_t>(all);
    face_ = Array<std::int32_t>(all);
    states_ = Array<std::uint8_t>(all), touch_ = Array<std::uint8_t>(all);
    ends_ = Array<std::int32_t>(2 * all), pairs_of_obstacle_ = Array<std::int32_t>(all);
    const auto numbers = [all](int of) {
      return Array<double>(all * static_cast<std::size_t>(of));
    };
    constants_ = numbers(of_constants), history_ = numbers(of_history);
    met_ = numbers(numbers_in<MetPair>), terms_ = numbers(numbers_in<PairTerms>);
    if (wears_) crushes_ = numbers(static_cast<int>(DevicePairs::crush));
    if (damps_)
      trials_ = numbers(numbers_in<ContactTrial>), sums_ = numbers(numbers_in<PairWrench>);
  }

  /// Notes where the bodies of a run are.
  void keep_places(std::size_t run, const Array<double>& records) {
    for (std::size_t n = 0; n < of_listed; ++n) {
      const std::size_t at = n * bodies_ + static_cast<std::size_t>(first_body_[run]);
      listed_.take(records, at, bodies_of(run), at);
    }
  }
  void get_solids(std::size_t run, Pairs& pairs) const {
    const auto first = static_cast<std::size_t>(runs_[run].first_pair);
    std::vector<std::int32_t> a(pairs.solids.size()), b(a.size());
    a_.get(a, first);
    b_.get(b, first);
    for (std::size_t k = 0; k < a.size(); ++k)
      pairs.solids[k] = {a[k] - first_body_[run], of_run(run, b[k])};
  }
  /// Returns a solid as in Pairs.
  std::int32_t of_run(std::size_t run, std::int32_t solid) const {
    const auto bodies = static_cast<std::int32_t>(bodies_);
    if (solid < bodies) return solid - first_body_[run];
    return static_cast<std::int32_t>(bodies_of(run)) + solid - bodies - first_obstacle_[run];
  }

  template <std::size_t n>
  static void put_rows(Array<double>& memory, std::size_t size, std::size_t first,
                       const std::vector<std::array<double, n>>& rows) {
    std::vector<double> row(rows.size());
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t p = 0; p < rows.size(); ++p) row[p] = rows[p][k];
      memory.put(std::span<const double>(row), k * size + first);
    }
  }

  /// Hands over the pairs of a run.
  void upload(std::size_t run) {
    const Pairs& pairs = pairs_[run];
    const auto first = static_cast<std::size_t>(runs_[run].first_pair);
    const std::size_t count = pairs.solids.size(), bodies = bodies_of(run),
                      obstacles = obstacles_of(run);
    std::vector<std::vector<std::int32_t>> of_solid(bodies + obstacles);
    std::vector<std::int32_t> a, b;
    for (std::size_t p = 0; p < count; ++p) {
      const auto place = static_cast<std::int32_t>(first + p);
      const auto [of_a, of_b] = pairs.solids[p];
      a.push_back(first_body_[run] + of_a);
      const bool on_body = static_cast<std::size_t>(of_b) < bodies;
      b.push_back(on_body ? first_body_[run] + of_b
                          : static_cast<std::int32_t>(bodies_) + first_obstacle_[run] + of_b -
                                static_cast<std::int32_t>(bodies));
      of_solid[static_cast<std::size_t>(of_a)].push_back(2 * place);
      const std::int32_t body_of_b = on_body ? of_b : carrier(run, of_b);
      if (body_of_b >= 0) of_solid[static_cast<std::size_t>(body_of_b)].push_back(2 * place + 1);
      if (!on_body) of_solid[static_cast<std::size_t>(of_b)].push_back(place);
    }
    a_.put(a, first);
    b_.put(b, first);
    face_.put(std::vector<std::int32_t>(count, -1), first);
    states_.put(pairs.states, first);
    touch_.put(std::vector<std::uint8_t>(count), first);
    put_rows(constants_, a_.size(), first, pairs.numbers);
    put_rows(history_, a_.size(), first, pairs.histories);
    if (runs_[run].wears != 0) put_rows(crushes_, a_.size(), first, pairs.crushes);
    put_lists(std::span(of_solid).first(bodies), 2 * first, first_end_, end_count_, ends_,
              static_cast<std::size_t>(first_body_[run]));
    put_lists(std::span(of_solid).subspan(bodies), first, first_of_obstacle_, count_of_obstacle_,
              pairs_of_obstacle_, static_cast<std::size_t>(first_obstacle_[run]));
  }
  static void put_lists(std::span<const std::vector<std::int32_t>> lists, std::size_t first,
                        Array<std::int32_t>& begins, Array<std::int32_t>& counts,
                        Array<std::int32_t>& entries, std::size_t of) {
    std::vector<std::int32_t> begin, number, all;
    for (const auto& list : lists) {
      begin.push_back(static_cast<std::int32_t>(first + all.size()));
      number.push_back(static_cast<std::int32_t>(list.size()));
      all.insert(all.end(), list.begin(), list.end());
    }
    begins.put(begin, of);
    counts.put(number, of);
    entries.put(all, first);
  }

  static constexpr int of_constants = static_cast<int>(DevicePairs::constants);

  std::vector<ContactsOfRun> runs_;
  std::vector<std::int32_t> first_body_{0}, first_obstacle_{0};
  std::vector<std::int32_t> carriers_;  ///< per obstacle of all runs: a body of all, or -1
  std::vector<Pairs> pairs_;            ///< per run, as they were put last
  std::vector<std::size_t> room_;       ///< per run, of pairs
  std::size_t bodies_ = 0;
  bool damps_ = false, wears_ = false;
  PairLister lister_;
  Array<ContactsOfRun> runs_here_;
  Array<std::int32_t> first_vertex_, first_plane_, graph_, first_end_, end_count_, ends_,
      run_of_obstacle_, carriers_here_, first_of_obstacle_, count_of_obstacle_, pairs_of_obstacle_,
      run_of_block_, a_, b_, face_;
  Array<double> vertices_, radius_, rest_, inverse_, listed_, others_, predicted_, works_, motions_,
      obstacle_forces_, obstacle_works_, constants_, met_, history_, trials_, sums_, terms_,
      accelerations_, crushes_;
  Array<HalfSpace> planes_, worn_;
  Array<std::int32_t> worn_planes_;
  Array<EdgeGraph> graphs_;
  Array<std::uint8_t> states_, touch_;
};

}  // namespace
}  // namespace floe::device
