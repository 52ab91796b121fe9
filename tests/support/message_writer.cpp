#include "tests/support/message_writer.hpp"

namespace stillpoint {

MessageWriter& MessageWriter::text(std::string_view value) {
  number(static_cast<std::uint32_t>(value.size() + (cdr_ ? 1 : 0)));
  bytes_ += value;
  if (cdr_) bytes_ += '\0';
  return *this;
}

MessageWriter& MessageWriter::bytes(std::string_view value) {
  number(static_cast<std::uint32_t>(value.size()));
  bytes_ += value;
  return *this;
}

MessageWriter& MessageWriter::header(std::int64_t stamp_ns, std::string_view frame) {
  if (!cdr_) number(std::uint32_t{7});
  number(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
  number(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
  return text(frame);
}

MessageWriter& MessageWriter::pose(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  for (int i = 0; i < 3; ++i) number(pose.translation()[i]);
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) number(value);
  return *this;
}

std::string image_bytes(bool cdr, std::int64_t stamp, std::string_view frame, std::string_view encoding,
                        const cv::Mat& pixels) {
  const cv::Mat whole = pixels.isContinuous() ? pixels : pixels.clone();
  const std::size_t step = static_cast<std::size_t>(whole.cols) * whole.elemSize();
  MessageWriter writer(cdr);
  writer.header(stamp, frame);
  writer.number(static_cast<std::uint32_t>(whole.rows)).number(static_cast<std::uint32_t>(whole.cols));
  writer.text(encoding).number(std::uint8_t{0}).number(static_cast<std::uint32_t>(step));
  writer.bytes({reinterpret_cast<const char*>(whole.data), step * static_cast<std::size_t>(whole.rows)});
  return writer.take();
}

std::string compressed_bytes(bool cdr, std::int64_t stamp, std::string_view frame, std::string_view format,
                             std::string_view data) {
  return MessageWriter(cdr).header(stamp, frame).text(format).bytes(data).take();
}

std::string info_bytes(bool cdr, std::int64_t stamp, const InfoExample& info) {
  MessageWriter writer(cdr);
  writer.header(stamp, info.frame).number(info.height).number(info.width).text(info.model);
  writer.number(static_cast<std::uint32_t>(info.d.size()));
  for (const double value : info.d) writer.number(value);
  for (const double value : {info.fx, 0.0, info.cx, 0.0, info.fy, info.cy, 0.0, 0.0, 1.0})
    writer.number(value);
  for (const double value : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) writer.number(value);
  for (const double value :
       {info.fx / 2, 0.0, info.cx, 0.0, 0.0, info.fy / 2, info.cy, 0.0, 0.0, 0.0, 1.0, 0.0})
    writer.number(value);
  writer.number(info.binning).number(info.binning);
  const auto [x, y, width, height] = info.roi;
  for (const std::uint32_t value : {x, y, height, width}) writer.number(value);
  return writer.number(std::uint8_t{0}).take();
}

std::string tf_bytes(bool cdr, const std::vector<TransformExample>& transforms) {
  MessageWriter writer(cdr);
  writer.number(static_cast<std::uint32_t>(transforms.size()));
  for (const TransformExample& transform : transforms)
    writer.header(transform.stamp, transform.parent).text(transform.child).pose(transform.pose);
  return writer.take();
}

std::string pose_bytes(bool cdr, std::int64_t stamp, std::string_view frame, const Pose& pose) {
  return MessageWriter(cdr).header(stamp, frame).pose(pose).take();
}

}  // namespace stillpoint
