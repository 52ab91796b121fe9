#include "core/run/sequence_origin.hpp"

#include <nlohmann/json.hpp>

#include "core/sequence/fingerprint.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// What a camera is made of, by name.
template <typename CameraType, typename Visit>
void visit_camera(CameraType& camera, const Visit& visit) {
  visit("name", camera.name);
  visit("width", camera.width);
  visit("height", camera.height);
  visit("fx", camera.fx);
  visit("fy", camera.fy);
  visit("cx", camera.cx);
  visit("cy", camera.cy);
  visit("k1", camera.k1);
  visit("k2", camera.k2);
  visit("p1", camera.p1);
  visit("p2", camera.p2);
  visit("k3", camera.k3);
  visit("depth_scale", camera.depth_scale);
  visit("readout_s", camera.readout_s);
}

}  // namespace

SequenceOrigin origin_of(const FrameSource& source, const std::string& where, const OpenOptions& options) {
  SequenceOrigin origin;
  origin.name = source.name();
  origin.where = where;
  std::error_code ignored;
  if (!origin.is_generated()) origin.where = fs::absolute(where, ignored).lexically_normal().string();
  origin.frames = source.size();
  origin.frames_asked = options.frames;
  origin.seed = options.seed;
  origin.frame_rate = options.frame_rate;
  origin.depth_offset_s = options.depth_offset_s;
  origin.truth = options.truth;
  origin.inverted_masks = options.inverted_masks;
  origin.depth_scale = options.depth_scale;
  origin.topics = options.topics;
  origin.stereo = options.stereo;
  origin.camera = source.camera();
  origin.has_depth = source.has_depth();
  origin.fingerprint = sequence_fingerprint(source);
  return origin;
}

namespace {

/// A depth camera beside the camera of the frames. Its place is written as it is, so that what is registered
/// by it is the same to the last bit.
nlohmann::ordered_json depth_camera_json(const DepthCamera& depth) {
  nlohmann::ordered_json json;
  visit_camera(depth.camera, [&json](const char* name, const auto& value) { json[name] = value; });
  for (int i = 0; i < 12; ++i)
    json["colour_from_depth"].push_back(depth.colour_from_depth.matrix()(i / 4, i % 4));
  return json;
}

std::shared_ptr<const DepthCamera> depth_camera_from_json(const nlohmann::json& json) {
  DepthCamera depth;
  visit_camera(depth.camera, [&json](const char* name, auto& value) { json.at(name).get_to(value); });
  const nlohmann::json& place = json.at("colour_from_depth");
  for (int i = 0; i < 12; ++i)
    depth.colour_from_depth.matrix()(i / 4, i % 4) = place.at(static_cast<std::size_t>(i)).get<double>();
  return std::make_shared<const DepthCamera>(depth);
}

}  // namespace

nlohmann::ordered_json to_json(const SequenceOrigin& origin, const fs::path& run_folder) {
  nlohmann::ordered_json json;
  json["name"] = origin.name;
  json["where"] = origin.where;
  std::error_code failed;
  if (!origin.is_generated() && !run_folder.empty()) {
    const fs::path relative = fs::proximate(origin.where, fs::absolute(run_folder, failed), failed);
    if (!failed) json["where_from_run"] = relative.string();
  }
  json["frames"] = origin.frames;
  json["frames_asked"] = origin.frames_asked;
  if (origin.is_generated()) json["seed"] = origin.seed;
  json["has_depth"] = origin.has_depth;
  if (origin.frame_rate != kFrameNumberRate) json["frame_rate"] = origin.frame_rate;
  if (origin.depth_offset_s != 0) json["depth_offset_s"] = origin.depth_offset_s;
  if (origin.truth != PoseConvention::as_written) json["truth"] = to_string(origin.truth);
  if (origin.inverted_masks) json["inverted_masks"] = true;
  if (origin.depth_scale) json["depth_scale"] = *origin.depth_scale;
  if (!origin.topics.empty()) json["topics"] = origin.topics;
  if (const std::string stereo = to_text(origin.stereo); !stereo.empty()) json["stereo"] = stereo;
  json["fingerprint"] = origin.fingerprint;
  visit_camera(origin.camera, [&json](const char* name, const auto& value) { json["camera"][name] = value; });
  if (origin.camera.depth_readout_s) json["camera"]["depth_readout_s"] = *origin.camera.depth_readout_s;
  if (origin.camera.stamp_delay_s != 0) json["camera"]["stamp_delay_s"] = origin.camera.stamp_delay_s;
  if (origin.camera.depth_delay_s != 0) json["camera"]["depth_delay_s"] = origin.camera.depth_delay_s;
  if (origin.camera.is_stereo()) {
    json["camera"]["baseline_m"] = origin.camera.baseline_m;
    json["camera"]["depth_sigma_per_m2"] = origin.camera.depth_sigma_per_m2;
  }
  if (origin.camera.depth_camera)
    json["camera"]["depth_camera"] = depth_camera_json(*origin.camera.depth_camera);
  return json;
}

SequenceOrigin origin_from_json(const nlohmann::json& json) {
  SequenceOrigin origin;
  json.at("name").get_to(origin.name);
  json.at("where").get_to(origin.where);
  origin.where_from_run = json.value("where_from_run", std::string());
  json.at("frames").get_to(origin.frames);
  json.at("frames_asked").get_to(origin.frames_asked);
  if (origin.is_generated()) json.at("seed").get_to(origin.seed);
  json.at("has_depth").get_to(origin.has_depth);
  origin.frame_rate = json.value("frame_rate", kFrameNumberRate);
  origin.depth_offset_s = json.value("depth_offset_s", 0.0);
  origin.truth = convention_by_name(json.value("truth", std::string())).value_or(PoseConvention::as_written);
  origin.inverted_masks = json.value("inverted_masks", false);
  if (json.contains("depth_scale")) origin.depth_scale = json.at("depth_scale").get<double>();
  origin.topics = json.value("topics", std::string());
  origin.stereo = stereo_options_from(json.value("stereo", std::string()), "stereo");
  json.at("fingerprint").get_to(origin.fingerprint);
  const nlohmann::json& camera = json.at("camera");
  visit_camera(origin.camera, [&camera](const char* name, auto& value) { camera.at(name).get_to(value); });
  if (camera.contains("depth_readout_s"))
    origin.camera.depth_readout_s = camera.at("depth_readout_s").get<double>();
  origin.camera.stamp_delay_s = camera.value("stamp_delay_s", 0.0);
  origin.camera.depth_delay_s = camera.value("depth_delay_s", 0.0);
  origin.camera.baseline_m = camera.value("baseline_m", 0.0);
  origin.camera.depth_sigma_per_m2 = camera.value("depth_sigma_per_m2", 0.0);
  if (camera.contains("depth_camera"))
    origin.camera.depth_camera = depth_camera_from_json(camera.at("depth_camera"));
  return origin;
}

}  // namespace stillpoint
