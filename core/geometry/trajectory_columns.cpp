#include "core/geometry/trajectory_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>

namespace stillpoint {
namespace {

constexpr std::size_t kRowsLookedAt = 64;  // rows: enough to tell a layout
// A stamp and a pose's 7 numbers; 3x4 of a matrix; a stamp, 7 and 9 more of the IMU's; a 4x4 matrix.
constexpr int kTumColumns = 8, kKittiColumns = 12, kEurocColumns = 17, kReplicaColumns = 16;
constexpr int kTartanAirColumns = 7;  // a pose's alone
constexpr int kStampedKittiColumns = kKittiColumns + 1, kStampedReplicaColumns = kReplicaColumns + 1;
constexpr double kRowLength = 0.02;  // of a matrix's row, how far from 1 its squared length may be

/// A header's cell in small letters, without its unit in brackets and blanks about it.
std::string plain(std::string_view cell) {
  cell = cell.substr(0, cell.find('['));
  std::string result;
  for (const char c : cell)
    if (!std::isspace(static_cast<unsigned char>(c)) && c != '"' && c != '#')
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> header_cells(const std::string& text) {
  std::vector<std::string> cells;
  const char separator = text.find(',') != std::string::npos   ? ','
                         : text.find(';') != std::string::npos ? ';'
                                                               : ' ';
  if (separator == ' ') {
    for (const std::string_view cell : split_columns(text))
      if (std::string name = plain(cell); !name.empty()) cells.push_back(std::move(name));
    return cells;
  }
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(separator, at), text.size());
    cells.push_back(plain(std::string_view(text).substr(at, end - at)));
    at = end + 1;
  }
  return cells;
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// What a header says: the first column of each role, -1 where none has it.
struct Header {
  int count = 0, time = -1, nanoseconds = -1;
  std::array<int, 3> position = {-1, -1, -1};
  std::array<int, 4> quaternion = {-1, -1, -1, -1};

  [[nodiscard]] bool names_quaternion() const {
    return *std::min_element(quaternion.begin(), quaternion.end()) >= 0;
  }
  [[nodiscard]] bool names_all() const {
    return time >= 0 && names_quaternion() && *std::min_element(position.begin(), position.end()) >= 0;
  }
};

bool ends_in(const std::string& text, std::initializer_list<std::string_view> ends) {
  return std::any_of(ends.begin(), ends.end(), [&text](std::string_view end) { return text.ends_with(end); });
}

Header read_header(const std::string& text) {
  Header header;
  // Of a message its header's stamp, and not the time at which it was recorded, which comes first in ROS's
  // tables: "%time, …, field.header.stamp", "Time, …, header.stamp.secs, header.stamp.nsecs".
  int stamp = -1, seconds = -1, nanoseconds = -1;
  const auto cells = header_cells(text);
  header.count = static_cast<int>(cells.size());
  const auto first = [](int& column, std::size_t at) {
    if (column < 0) column = static_cast<int>(at);
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string& cell = cells[i];
    if (cell.empty()) continue;
    const auto axis = std::string_view("xyzw").find(cell.back());
    if (ends_in(cell, {"stamp"})) first(stamp, i);
    if (has(cell, "stamp") && ends_in(cell, {"nsec", "nsecs", "nanosec", "nanosecs"}))
      first(nanoseconds, i);
    else if (has(cell, "stamp") && ends_in(cell, {".sec", ".secs", "_sec", "_secs"}))
      first(seconds, i);
    if (has(cell, "time") || has(cell, "stamp") || cell == "t" || cell == "sec") {
      first(header.time, i);
    } else if (axis != std::string_view::npos) {
      const bool quaternion = cell[0] == 'q' || has(cell, "quat") || has(cell, "orient") ||
                              has(cell, "rot") || has(cell, "_q") || has(cell, ".q") || cell == "w";
      const bool position = cell.size() == 1 || cell[0] == 't' || cell[0] == 'p' || has(cell, "pos") ||
                            has(cell, ".p") || has(cell, "trans");
      if (quaternion)
        first(header.quaternion[axis], i);
      else if (position && axis < 3)
        first(header.position[axis], i);
    }
  }
  if (stamp >= 0)
    header.time = stamp;
  else if (seconds >= 0 && nanoseconds >= 0)
    header.time = seconds, header.nanoseconds = nanoseconds;
  return header;
}

/// The number of columns most rows have, and whether their decimals are commas.
void count_columns(const std::vector<TextLine>& lines, std::size_t from, TrajectoryLayout& layout) {
  std::map<int, int> parted, with_commas;
  const std::size_t end = std::min(lines.size(), from + kRowsLookedAt);
  for (std::size_t i = from; i < end; ++i) {
    ++parted[static_cast<int>(split_columns(lines[i].text).size())];
    ++with_commas[static_cast<int>(split_decimal_comma_columns(lines[i].text).size())];
  }
  const auto most = [](const std::map<int, int>& counts) {
    return std::max_element(counts.begin(), counts.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; });
  };
  if (parted.empty()) return;
  const auto is_known = [](int columns) {
    return columns == kTumColumns || columns == kKittiColumns || columns == kEurocColumns ||
           columns == kReplicaColumns;
  };
  const int plain_count = most(parted)->first, comma_count = most(with_commas)->first;
  // Eight numbers with decimal commas are sixteen where commas part them.
  const bool doubled = comma_count == kTumColumns && plain_count == 2 * kTumColumns;
  layout.decimal_commas = is_known(comma_count) && (!is_known(plain_count) || doubled);
  layout.columns = layout.decimal_commas ? comma_count : plain_count;
}

void apply(const Header& header, TrajectoryLayout& layout) {
  if (header.names_all() && header.count == layout.columns) {
    layout.time = header.time, layout.nanoseconds = header.nanoseconds;
    layout.position = header.position, layout.quaternion = header.quaternion;
  } else if (!header.names_quaternion()) {
    return;
  }
  layout.order_is_named = true;
  layout.order = header.quaternion[3] < header.quaternion[0] ? QuaternionOrder::wxyz : QuaternionOrder::xyzw;
  if (!header.names_all() || header.count != layout.columns) layout.set_order(layout.order);
}

/// Whether rows hold a matrix behind their first column: EuRoC's have as many numbers as a stamp and a 4x4
/// matrix, and what has 13 may be anything. The first row that has all its numbers tells.
bool holds_stamped_matrices(const std::vector<TextLine>& lines, const TrajectoryLayout& layout) {
  const std::size_t end = std::min(lines.size(), layout.header_rows + kRowsLookedAt);
  for (auto at = static_cast<std::size_t>(layout.header_rows); at < end; ++at) {
    std::vector<double> n;
    for (const std::string_view column : layout.split(lines[at].text))
      if (const auto value = layout.number(column); value && std::isfinite(*value)) n.push_back(*value);
    if (static_cast<int>(n.size()) != layout.columns) continue;
    for (std::size_t row = 1; row < kKittiColumns; row += 4)
      if (std::abs(n[row] * n[row] + n[row + 1] * n[row + 1] + n[row + 2] * n[row + 2] - 1) > kRowLength)
        return false;
    return layout.columns == kStampedKittiColumns ||
           (n[13] == 0 && n[14] == 0 && n[15] == 0 && std::abs(n[16] - 1) < kRowLength);
  }
  return false;
}

/// Whether rows of 7 numbers are poses without a stamp: a stamp and six numbers end in no quaternion. All
/// rows that have their numbers tell, and one alone does not.
bool holds_bare_poses(const std::vector<TextLine>& lines, const TrajectoryLayout& layout) {
  const std::size_t end = std::min(lines.size(), layout.header_rows + kRowsLookedAt);
  int poses = 0;
  for (auto at = static_cast<std::size_t>(layout.header_rows); at < end; ++at) {
    std::vector<double> n;
    for (const std::string_view column : layout.split(lines[at].text))
      if (const auto value = layout.number(column); value && std::isfinite(*value)) n.push_back(*value);
    if (static_cast<int>(n.size()) != kTartanAirColumns) continue;
    if (std::abs(n[3] * n[3] + n[4] * n[4] + n[5] * n[5] + n[6] * n[6] - 1) > kRowLength) return false;
    ++poses;
  }
  return poses > 1;
}

}  // namespace

bool TrajectoryLayout::has_stamps() const {
  if (!is_matrix) return time >= 0;
  return columns == kStampedKittiColumns || columns == kStampedReplicaColumns;
}

void TrajectoryLayout::set_order(QuaternionOrder wanted_order) {
  const int first = *std::min_element(quaternion.begin(), quaternion.end());
  order = wanted_order;
  if (order == QuaternionOrder::wxyz)
    quaternion = {first + 1, first + 2, first + 3, first};
  else
    quaternion = {first, first + 1, first + 2, first + 3};
}

std::vector<std::string_view> TrajectoryLayout::split(std::string_view text) const {
  if (!decimal_commas) return split_columns(text);
  auto columns_of_text = split_decimal_comma_columns(text);
  return columns_of_text.empty() ? split_columns(text) : columns_of_text;
}

std::optional<double> TrajectoryLayout::number(std::string_view text) const {
  return decimal_commas ? parse_comma_number(text) : parse_number(text);
}

std::vector<int> TrajectoryLayout::wanted() const {
  if (is_matrix) {
    std::vector<int> all(kKittiColumns);
    std::iota(all.begin(), all.end(), has_stamps() ? 1 : 0);
    if (has_stamps()) all.push_back(time);
    return all;
  }
  std::vector<int> columns_wanted = {std::max(0, time)};
  columns_wanted.insert(columns_wanted.end(), position.begin(), position.end());
  columns_wanted.insert(columns_wanted.end(), quaternion.begin(), quaternion.end());
  if (nanoseconds >= 0) columns_wanted.push_back(nanoseconds);
  return columns_wanted;
}

std::string TrajectoryLayout::expected() const {
  if (is_matrix) {
    const bool whole = columns == kReplicaColumns || columns == kStampedReplicaColumns;
    return (has_stamps() ? "a stamp and " : "") +
           std::string(whole ? "the 16 numbers of a 4x4 matrix" : "the 12 numbers of a 3x4 matrix");
  }
  const bool w_first = order == QuaternionOrder::wxyz;
  const std::string tum = w_first ? "timestamp tx ty tz qw qx qy qz" : "timestamp tx ty tz qx qy qz qw";
  if (!has_stamps()) return "the 7 numbers tx ty tz qx qy qz qw";
  return columns == kTumColumns ? "the 8 numbers " + tum
                                : std::to_string(columns) + " columns with " + tum + " among them";
}

TrajectoryLayout find_layout(const std::vector<TextLine>& lines, const std::vector<TextLine>& comments) {
  TrajectoryLayout layout;
  std::optional<Header> header;
  if (!lines.empty()) {
    const Header first = read_header(lines.front().text);
    if (first.names_quaternion()) header = first, layout.header_rows = 1;
  }
  // The last one that names columns: what stands closest to the rows.
  for (auto comment = comments.rbegin(); comment != comments.rend() && !header; ++comment)
    if (const Header read = read_header(comment->text); read.names_quaternion()) header = read;
  count_columns(lines, static_cast<std::size_t>(layout.header_rows), layout);
  if (header) {
    apply(*header, layout);
    if (header->names_all() && header->count == layout.columns) return layout;
  }
  const bool may_be_stamped =
      layout.columns == kStampedKittiColumns || layout.columns == kStampedReplicaColumns;
  if (may_be_stamped && holds_stamped_matrices(lines, layout)) {
    layout.is_matrix = true;
  } else if (layout.columns == kEurocColumns) {
    layout.order_is_named = true;
    layout.set_order(QuaternionOrder::wxyz);
  } else if (layout.columns == kKittiColumns || layout.columns == kReplicaColumns) {
    layout.is_matrix = true;
  } else if (layout.columns == kTartanAirColumns && holds_bare_poses(lines, layout)) {
    layout.time = -1;
    layout.position = {0, 1, 2};
    layout.quaternion = {3, 4, 5, 6};
  } else {
    layout.columns = kTumColumns;
  }
  return layout;
}

}  // namespace stillpoint
