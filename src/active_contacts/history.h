/// \file
/// Histories of the pairs that touched at the last commit.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contact/pair.h"
#include "contact_laws/response.h"

namespace floe {

/// Histories in the order of the pair list.
class ContactHistory {
 public:
  /// The history of one pair.
  struct Entry {
    std::int32_t a = 0, b = 0;
    std::int32_t pair = -1;  ///< index in the list; -1: from a checkpoint
    PairHistory memory;
  };
  /// Finds the histories of pairs that are asked for in the order of the list.
  class Cursor {
   public:
    explicit Cursor(const ContactHistory& history) : next_(history.entries_) {}
    explicit Cursor(std::span<const Entry> entries) : next_(entries) {}
    /// Returns the history of a pair; null: the pair has none.
    const PairHistory* of(std::int32_t pair) {
      while (!next_.empty() && next_.front().pair < pair) next_ = next_.subspan(1);
      if (next_.empty() || next_.front().pair != pair) return nullptr;
      const PairHistory* memory = &next_.front().memory;
      next_ = next_.subspan(1);
      return memory;
    }

   private:
    std::span<const Entry> next_;
  };

  std::size_t size() const { return entries_.size(); }
  /// Histories in the order of the list.
  std::span<const Entry> entries() const { return entries_; }

  /// Begins a commit.
  void start() {
    std::swap(entries_, next_);
    entries_.clear();
  }
  /// Finds the histories before the commit that was begun last.
  Cursor before() const { return Cursor(next_); }
  void add(const Entry& entry) { entries_.push_back(entry); }
  /// Gives the history of a pair to another pair of the same body, where it joins that which the
  /// other one may have. \param pairs  of the list
  void move(std::int32_t from, std::int32_t to, std::span<const Pair> pairs);
  /// Assigns the histories to the pairs of a new list; pairs with history are not newly eligible.
  void take_over(std::span<Pair> pairs);

  /// Numbers per pair in a checkpoint: A, B and those of the history of the pair.
  static constexpr std::size_t width = 2 + PairHistory::numbers;
  /// Returns rows of `width` numbers for the counted pairs.
  /// \param pairs  of the list
  std::vector<double> rows(std::span<const Pair> pairs) const;
  /// Sets the histories that the next take_over() assigns.
  /// \param rows  of the pairs of all ranks, sorted by pair
  void restore(std::span<const double> rows);

 private:
  std::vector<Entry> entries_;
  std::vector<Entry> next_;  ///< work space; during a commit the histories before it
};

}  // namespace floe
