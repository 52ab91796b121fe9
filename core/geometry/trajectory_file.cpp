#include "core/geometry/trajectory_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "core/geometry/trajectory_columns.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

constexpr double kLengthTolerance = 0.01;   // quaternions farther from unit length are no rotations
constexpr double kLengthRemarkable = 1e-3;  // four decimals, as the benchmark writes, stay below this
constexpr double kFarthest = 1e9;           // m; what is farther away was never measured
constexpr int kFewRows = 4;                 // below, repeated stamps say nothing about a file

/// Something that befell several rows, told in one sentence.
struct Mishap {
  int count = 0, first_line = 0;
  void note(int line) {
    if (count++ == 0) first_line = line;
  }
  void tell(TrajectoryFile& file, const std::string& path, const std::string& what) const {
    if (count > 0)
      file.warnings.push_back(fmt::format("{}:{}: {} ({} in all)", path, first_line, what, count));
  }
};

struct ReadPose {
  StampedPose pose;
  int line = 0;
};

/// A row's numbers as TrajectoryLayout::wanted has them: 8 and perhaps nanoseconds, or a matrix's 12 and
/// perhaps a stamp.
using Numbers = std::array<double, 13>;
constexpr std::size_t kMatrixStamp = 12, kNanoseconds = 8;  // where those stand

/// Why a row holds no pose.
enum class Fault { none, columns, number, not_finite, absurd, quaternion };

class TrajectoryReader {
 public:
  TrajectoryReader(const std::string& path, std::string_view text, std::optional<QuaternionOrder> order)
      : path_(path) {
    std::vector<TextLine> comments;
    lines_ = text_lines(text, &comments);
    layout_ = find_layout(lines_, comments);
    if (layout_.header_rows > 0) lines_.erase(lines_.begin());
    if (order && !layout_.is_matrix) layout_.set_order(*order);
  }

  [[nodiscard]] TrajectoryFile read() {
    file_.rows = static_cast<int>(lines_.size());
    file_.order = layout_.order, file_.order_is_named = layout_.order_is_named;
    file_.has_stamps = layout_.has_stamps();
    std::vector<ReadPose> poses;
    for (const TextLine& line : lines_) read_row(line, poses);
    judge(poses);
    put_in_order(poses);
    return std::move(file_);
  }

 private:
  void read_row(const TextLine& line, std::vector<ReadPose>& poses) {
    ReadPose read;
    read.line = line.number;
    // A row that holds no pose counts where rows stand for times.
    switch (pose_of(line, static_cast<int>(poses.size()) + file_.skipped, read.pose)) {
      case Fault::none:
        if (!poses.empty() && read.pose.timestamp < poses.back().pose.timestamp) unsorted_.note(line.number);
        poses.push_back(read);
        return;
      case Fault::not_finite:
        not_finite_.note(line.number);
        break;
      case Fault::absurd:
        absurd_.note(line.number);
        break;
      case Fault::quaternion:
        quaternions_.note(line.number);
        break;
      case Fault::columns:
      case Fault::number:
        malformed_.note(line.number);
        break;
    }
    ++file_.skipped;
  }

  Fault pose_of(const TextLine& line, int row, StampedPose& pose) {
    const auto columns = layout_.split(line.text);
    if (static_cast<int>(columns.size()) != layout_.columns) {
      fault(line, fmt::format("found {} columns, expected {}", columns.size(), layout_.expected()));
      return Fault::columns;
    }
    bool finite = true;
    const auto number = [&](int column) {
      const auto value = layout_.number(columns[static_cast<std::size_t>(column)]);
      if (!value || !std::isfinite(*value))
        fault(line, fmt::format("found {} in column {}, expected a finite number ({})",
                                in_quotes(columns[static_cast<std::size_t>(column)]), column + 1,
                                layout_.expected()));
      finite = finite && (!value || std::isfinite(*value));
      return value;
    };
    Numbers n{};
    const std::vector<int> wanted = layout_.wanted();
    bool whole = true;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const auto value = number(wanted[i]);
      whole = whole && value.has_value();
      n[i] = value.value_or(0.0);
    }
    if (!whole) return Fault::number;
    if (!finite) return Fault::not_finite;
    const std::array<std::size_t, 3> position =
        layout_.is_matrix ? std::array<std::size_t, 3>{3, 7, 11} : std::array<std::size_t, 3>{1, 2, 3};
    const double stamp = n[layout_.is_matrix ? kMatrixStamp : 0];
    if ((layout_.has_stamps() && !is_stamp(stamp)) ||
        std::any_of(position.begin(), position.end(),
                    [&n](std::size_t i) { return std::abs(n[i]) > kFarthest; })) {
      fault(line, "found a stamp or a position beyond all measure");
      return Fault::absurd;
    }
    return layout_.is_matrix ? from_matrix(line, row, n, pose) : from_quaternion(line, row, n, pose);
  }

  Fault from_quaternion(const TextLine& line, int row, const Numbers& n, StampedPose& pose) {
    const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
    const double length = q.norm();
    if (!(std::abs(length - 1.0) < kLengthTolerance)) {
      fault(line, fmt::format("found a quaternion of length {:.4g}, expected length 1", length));
      return Fault::quaternion;
    }
    if (std::abs(length - 1.0) > kLengthRemarkable) normalised_.note(line.number);
    pose.timestamp = layout_.has_stamps() ? n[0] + (layout_.nanoseconds >= 0 ? 1e-9 * n[kNanoseconds] : 0.0)
                                          : static_cast<double>(row);
    pose.world_from_camera.linear() = q.normalized().toRotationMatrix();
    pose.world_from_camera.translation() = Eigen::Vector3d(n[1], n[2], n[3]);
    return Fault::none;
  }

  Fault from_matrix(const TextLine& line, int row, const Numbers& n, StampedPose& pose) {
    Eigen::Matrix3d rotation;
    rotation << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
    if (!((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 10 * kLengthTolerance) ||
        rotation.determinant() < 0) {
      fault(line, fmt::format("found numbers that are no rotation and translation, expected {}",
                              layout_.expected()));
      return Fault::quaternion;
    }
    pose.timestamp = layout_.has_stamps() ? n[kMatrixStamp] : row;
    pose.world_from_camera.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    pose.world_from_camera.translation() = Eigen::Vector3d(n[3], n[7], n[11]);
    return Fault::none;
  }

  void fault(const TextLine& line, const std::string& what) {
    if (first_fault_.empty()) first_fault_ = fmt::format("{}:{}: {}", path_, line.number, what);
  }

  /// Refuses a file that is not what it was read as.
  void judge(const std::vector<ReadPose>& poses) const {
    if (file_.rows == 0)
      throw InputError(fmt::format("{}: holds no poses, expected lines of {}", path_, layout_.expected()));
    const int wrong = malformed_.count + quaternions_.count;
    if (poses.empty() || 2 * wrong >= file_.rows)
      throw InputError(file_.rows == 1 ? first_fault_
                                       : fmt::format("{} ({} of {} rows hold no pose)", first_fault_,
                                                     file_.skipped, file_.rows));
  }

  void put_in_order(std::vector<ReadPose>& poses) {
    std::stable_sort(poses.begin(), poses.end(), [](const ReadPose& a, const ReadPose& b) {
      return a.pose.timestamp < b.pose.timestamp;
    });
    file_.poses.reserve(poses.size());
    for (const ReadPose& read : poses) {
      if (!file_.poses.empty() && read.pose.timestamp == file_.poses.back().timestamp)
        repeated_.note(read.line);
      else
        file_.poses.push_back(read.pose);
    }
    if (file_.rows >= kFewRows && 2 * repeated_.count > file_.rows)
      throw InputError(
          fmt::format("{}:{}: {} of {} poses repeat an earlier stamp: the stamps were written with too "
                      "few digits to tell frames apart",
                      path_, repeated_.first_line, repeated_.count, file_.rows));
    not_finite_.tell(file_, path_, "a row of NaN or infinity holds no pose and was skipped");
    absurd_.tell(file_, path_, "a row's stamp or position is beyond all measure and it was skipped");
    malformed_.tell(file_, path_,
                    fmt::format("a row holds no pose (expected {}) and was skipped", layout_.expected()));
    quaternions_.tell(file_, path_, "a row's rotation is none (zero, or off unit length) and it was skipped");
    unsorted_.tell(file_, path_, "a pose is earlier than the one before it; poses were sorted by time");
    repeated_.tell(file_, path_, "a pose repeats an earlier timestamp and was dropped");
    normalised_.tell(file_, path_, "a quaternion is not of unit length and was normalised");
  }

  const std::string& path_;
  std::vector<TextLine> lines_;
  TrajectoryLayout layout_;
  TrajectoryFile file_;
  Mishap not_finite_, absurd_, malformed_, quaternions_, unsorted_, repeated_, normalised_;
  std::string first_fault_;
};

}  // namespace

TrajectoryFile read_trajectory_file(const std::string& path, std::optional<QuaternionOrder> order) {
  return TrajectoryReader(path, read_text(path), order).read();
}

TrajectoryFile read_trajectory_text(const std::string& path, std::string_view text,
                                    std::optional<QuaternionOrder> order) {
  return TrajectoryReader(path, text, order).read();
}

}  // namespace stillpoint
