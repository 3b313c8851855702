#include "options/spelling.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace floe {

int spelling_distance(std::string_view a, std::string_view b) {
  std::vector<int> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    row[0] = static_cast<int>(i) + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({last[j] + (a[i] != b[j]), last[j + 1] + 1, row[j] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
        row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
    before = std::exchange(last, row);
  }
  return last.back();
}

std::string nearest_word(std::string_view word, std::span<const std::string_view> known) {
  std::string nearest;
  int best = std::max(2, static_cast<int>(word.size()) / 3) + 1;
  for (const std::string_view candidate : known) {
    const int far = spelling_distance(word, candidate);
    if (far >= best) continue;
    best = far;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace floe
