#include "run_folder/crash_summary.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>

#include "files/files.h"

namespace floe {
namespace {

using Text = std::array<char, 3000>;  // less than the reserved room

/// The inside of a JSON string (RFC 8259, section 7), cut where the room ends.
Text escaped(const char* words) {
  Text text{};
  constexpr std::size_t longest = 6;  // \u001f
  std::size_t end = 0;
  for (; *words != '\0' && end + longest < text.size(); ++words) {
    const auto c = static_cast<unsigned char>(*words);
    constexpr unsigned char first_printed = 0x20, first_beyond_ascii = 0x7f;
    if (c == '"' || c == '\\') {
      text[end++] = '\\';
      text[end++] = *words;
    } else if (c < first_printed) {
      end += static_cast<std::size_t>(
          std::snprintf(&text[end], longest + 1, "\\u%04x", static_cast<unsigned>(c)));
    } else {
      text[end++] = c < first_beyond_ascii ? *words : '?';
    }
  }
  return text;
}

/// The date and time as date_and_time() gives it, whose functions of the C library hold locks.
std::array<char, 40> now(long utc_offset) {
  using namespace std::chrono;
  const sys_seconds local = floor<seconds>(system_clock::now()) + seconds(utc_offset);
  const auto day = floor<days>(local);
  const year_month_day date(day);
  const hh_mm_ss time(local - day);
  const hh_mm_ss offset(seconds(std::abs(utc_offset)));
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d%c%02d:%02d",
                static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(time.hours().count()),
                static_cast<int>(time.minutes().count()), static_cast<int>(time.seconds().count()),
                utc_offset < 0 ? '-' : '+', static_cast<int>(offset.hours().count()),
                static_cast<int>(offset.minutes().count()));
  return text;
}

long offset_of_local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&now, &local);
  return local.tm_gmtoff;
}

}  // namespace

CrashSummary::CrashSummary(const std::string& dir, const std::string& reserved,
                           const std::string& facts)
    : reserved_(dir + reserved),
      summary_(dir + "/summary.json"),
      facts_(facts.substr(facts.find_first_not_of("{ \n"))),
      utc_offset_(offset_of_local_time()) {}

bool CrashSummary::write(const char* why, double time, long long step) const noexcept {
  std::array<char, 4096> head{};
  const int length = std::snprintf(
      head.data(), head.size(),
      "{\n  \"status\": \"failed\",\n  \"message\": \"%s\",\n  \"time\": %.17g,\n"
      "  \"steps\": %lld,\n  \"ended\": \"%s\",\n  ",
      escaped(why).data(), std::isfinite(time) ? time : 0.0, step, now(utc_offset_).data());
  const int file = ::open(reserved_.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return false;
  const std::string_view front(head.data(), static_cast<std::size_t>(length));
  const auto size = static_cast<off_t>(front.size() + facts_.size());
  const bool good =
      write_all(file, front) && write_all(file, facts_) && ::ftruncate(file, size) == 0;
  ::close(file);
  return good && std::rename(reserved_.c_str(), summary_.c_str()) == 0;
}

}  // namespace floe
