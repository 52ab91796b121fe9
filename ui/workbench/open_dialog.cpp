#include "ui/workbench/open_dialog.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/error.hpp"
#include "core/motion/methods.hpp"
#include "core/run/records_file.hpp"
#include "ui/panels/frame_pictures.hpp"
#include "ui/session/opened_source.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr int kPictureWidth = 480;  // px

/// A row of choices by name, the first for what is found. @returns whether another was chosen
bool choose_from(const char* label, const char* first, const std::vector<std::string>& names, int& chosen) {
  const int before = chosen;
  const std::string shown = chosen == 0 ? first : names[static_cast<std::size_t>(chosen - 1)];
  if (!ImGui::BeginCombo(label, shown.c_str())) return false;
  if (ImGui::Selectable(first, chosen == 0)) chosen = 0;
  for (int i = 0; i < static_cast<int>(names.size()); ++i)
    if (ImGui::Selectable(names[static_cast<std::size_t>(i)].c_str(), chosen == i + 1)) chosen = i + 1;
  ImGui::EndCombo();
  return chosen != before;
}

const char* kind_words(PlaceKind kind) {
  switch (kind) {
    case PlaceKind::folder:
      return "";
    case PlaceKind::sequence:
      return "sequence";
    case PlaceKind::run:
      return "finished run";
    case PlaceKind::file:
      return "file";
  }
  return "";
}

}  // namespace

PlaceLook look_at_place(const OpenAs& place, const std::function<OpenedSource(const OpenAs&)>& opens) {
  PlaceLook look{.of = place};
  try {
    const OpenedSource opened = opens(place);
    look.facts = sequence_facts(*opened.source);
    if (opened.options.recorded)
      look.facts.insert(look.facts.begin(), {"Run", fmt::format("{} frames by {}", opened.frames,
                                                                run_name(*opened.options.recorded))});
    if (!opened.options.no_images.empty()) {
      look.findings.push_back({"images", opened.options.no_images});
      return look;
    }
    look.findings = check_frames(*opened.source);
    if (opened.source->size() == 0) return look;
    const Frame first = opened.source->read(0);
    if (!first.readable()) return look;
    const cv::Mat& picture = picture_of(first);
    const double scale = std::min(1.0, static_cast<double>(kPictureWidth) / picture.cols);
    cv::resize(picture, look.picture, {}, scale, scale, cv::INTER_AREA);
  } catch (const std::exception& error) {
    look.problem = error.what();
  }
  return look;
}

void OpenDialog::open(const std::string& beside, const std::string& method) {
  open_ = opened_now_ = true;
  method_ = method;
  std::error_code none;
  const fs::path place = fs::absolute(beside, none);
  if (!beside.empty() && fs::exists(place, none))
    go_to(place.parent_path());
  else if (folder_.empty())
    go_to(fs::current_path(none));
  else
    go_to(folder_);  // what lies there may have changed
}

void OpenDialog::go_to(const fs::path& folder) {
  folder_ = folder.lexically_normal();
  problem_.clear();
  places_.clear();
  try {
    places_ = places_in(folder_);
  } catch (const std::exception& error) {
    problem_ = error.what();
  }
}

void OpenDialog::choose(const std::string& where) {
  const std::size_t length = where.copy(path_, sizeof path_ - 1);
  path_[length] = '\0';
}

OpenAs OpenDialog::wanted() const {
  OpenAs as{.where = path_, .method = method_};
  if (camera_ > 0)
    as.reading.push_back("camera=" + known_cameras()[static_cast<std::size_t>(camera_ - 1)].name);
  if (frames_ > 0) as.reading.push_back(fmt::format("frames={}", frames_));
  if (depth_scale_ > 0) as.reading.push_back(fmt::format("depth_scale={}", depth_scale_));
  if (truth_ > 0)
    as.reading.push_back(
        fmt::format("truth={}", to_string(other_conventions()[static_cast<std::size_t>(truth_ - 1)])));
  if (inverted_masks_) as.reading.emplace_back("invert_masks=true");
  return as;
}

void OpenDialog::take_look(const UiFrame& frame) {
  if (looking_.valid() && looking_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    seen_ = looking_.get();
    picture_.reset();
    if (!seen_->picture.empty()) picture_.emplace(frame.gl, Sampling::kLinear).upload(seen_->picture);
  }
  // Of places chosen while one is looked at, the last is next.
  OpenAs now = wanted();
  now.method.clear();  // what is in a place is the same for every method
  if (!look_at_ || looking_.valid() || now == asked_) return;
  seen_.reset();
  asked_ = now;
  const auto kind = kind_of_place(now.where);
  is_folder_ = kind == PlaceKind::folder;
  if (!now.where.starts_with("generated:") && (!kind || kind == PlaceKind::folder)) return;
  looking_ = std::async(std::launch::async, [look = look_at_, now] { return look(now); });
}

std::optional<OpenAs> OpenDialog::accept() {
  std::error_code none;
  OpenAs as = wanted();
  // A folder of folders is gone into; whatever else was typed is opened, or why not is said.
  if (kind_of_place(as.where) == PlaceKind::folder) {
    go_to(fs::absolute(as.where, none));
    opened_now_ = true;  // the next place is typed on
    return std::nullopt;
  }
  if (as.where.empty()) return std::nullopt;
  open_ = false;
  return as;
}

std::optional<OpenAs> OpenDialog::draw(UiFrame& frame, const std::vector<std::string>& recent) {
  if (!open_) return std::nullopt;
  take_look(frame);
  if (looking_.valid()) frame.redraw_after_s = std::min(frame.redraw_after_s, 0.1);
  const float scale = frame.scale;
  const ImVec2 size{std::min(980.0F * scale, frame.size.x - 20.0F),
                    std::min(600.0F * scale, 0.86F * frame.size.y)};
  ImGui::SetNextWindowPos({0.5F * (frame.size.x - size.x), 0.07F * frame.size.y});
  ImGui::SetNextWindowSize(size);
  if (opened_now_) ImGui::SetNextWindowFocus();
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {14.0F * scale, 12.0F * scale});
  ImGui::PushStyleColor(ImGuiCol_Border, to_vec4(mix(frame.theme.border, frame.theme.accent, 0.5F)));
  ImGui::Begin("##open", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  std::optional<OpenAs> chosen;
  // Escape closes a list that hangs open first.
  const bool list_open = ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
  ImGui::PushFont(frame.fonts.strong);
  ImGui::TextUnformatted("Open a sequence or a finished run");
  ImGui::PopFont();
  if (opened_now_) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1.0F);
  const bool entered =
      ImGui::InputTextWithHint("##path", "A folder, an archive, a bag, a video, or generated:KIND", path_,
                               sizeof path_, ImGuiInputTextFlags_EnterReturnsTrue);
  const float below = ImGui::GetFrameHeightWithSpacing();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  ImGui::BeginChild("places", {0.42F * room.x, room.y - below}, true);
  chosen = draw_places(frame, recent);
  ImGui::EndChild();
  ImGui::SameLine();
  // What is found comes and goes; how it is read stays where it is.
  constexpr float kReadingRows = 6.0F;
  ImGui::BeginGroup();
  const float reading = kReadingRows * ImGui::GetFrameHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
  ImGui::BeginChild("chosen", {0.0F, room.y - below - reading}, true);
  draw_chosen(frame);
  ImGui::EndChild();
  draw_reading(frame);
  ImGui::EndGroup();
  ImGui::BeginDisabled(path_[0] == '\0');
  const bool pressed = ImGui::Button("Open", {110.0F * scale, 0.0F});
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (ImGui::Button("Cancel") || (!list_open && is_key_pressed(Key::kEscape))) open_ = false;
  ImGui::End();
  opened_now_ = false;
  if (entered || pressed) chosen = accept();
  return chosen;
}

std::optional<OpenAs> OpenDialog::draw_places(const UiFrame& frame, const std::vector<std::string>& recent) {
  std::optional<fs::path> go;
  std::optional<OpenAs> chosen;
  ImGui::PushFont(frame.fonts.small);
  text_in_room(folder_.string(), frame.theme.text_dim);
  ImGui::PopFont();
  if (folder_.has_relative_path() && ImGui::Selectable(fmt::format("{}  ..", icons::kFolderOpen).c_str()))
    go = folder_.parent_path();
  for (const OpenPlace& place : places_) {
    const std::string where = (folder_ / place.name).string();
    ImGui::PushID(where.c_str());
    const char* icon = place.kind == PlaceKind::folder ? icons::kFolderOpen
                       : place.kind == PlaceKind::run  ? icons::kPlay
                                                       : icons::kFilm;
    const float left = ImGui::GetCursorPosX();
    if (ImGui::Selectable(fmt::format("{}  {}", icon, place.name).c_str(), where == path_,
                          ImGuiSelectableFlags_AllowDoubleClick | ImGuiSelectableFlags_AllowItemOverlap)) {
      choose(where);
      if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
        if (place.kind == PlaceKind::folder)
          go = where;
        else
          chosen = wanted(), open_ = false;
      }
    }
    if (const std::string kind = kind_words(place.kind); !kind.empty()) {
      ImGui::PushFont(frame.fonts.small);
      ImGui::SameLine(
          std::max(left, ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(kind.c_str()).x));
      ImGui::TextColored(to_vec4(frame.theme.text_dim), "%s", kind.c_str());
      ImGui::PopFont();
    }
    ImGui::PopID();
  }
  if (places_.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(frame.theme.text_dim));
    ImGui::TextWrapped("%s", problem_.empty() ? "There is nothing here that opens." : problem_.c_str());
    ImGui::PopStyleColor();
  }
  if (!recent.empty()) {
    ImGui::Separator();
    ImGui::TextDisabled("Recent, as they were left");
    for (const std::string& where : recent)
      if (ImGui::Selectable(where.c_str(), false)) chosen = OpenAs{.where = where}, open_ = false;
  }
  if (go) go_to(*go);
  return chosen;
}

void OpenDialog::draw_chosen(const UiFrame& frame) {
  const auto dim = to_vec4(frame.theme.text_dim);
  if (looking_.valid()) {
    ImGui::TextColored(dim, "Looking at it…");
  } else if (!seen_) {
    ImGui::PushStyleColor(ImGuiCol_Text, dim);
    ImGui::TextWrapped("%s", path_[0] == '\0'
                                 ? "Choose a place: what is in it shows here before it is opened. A double "
                                   "click opens it."
                             : is_folder_ ? "Enter goes into this folder."
                                          : "There is nothing here that opens.");
    ImGui::PopStyleColor();
  } else if (!seen_->problem.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, to_vec4(role_colour(Role::kWarning, frame.theme.name)));
    ImGui::TextWrapped("%s", seen_->problem.c_str());
    ImGui::PopStyleColor();
  } else {
    if (picture_) {
      const float width = 0.46F * ImGui::GetContentRegionAvail().x;
      const float height =
          width * static_cast<float>(picture_->height()) / static_cast<float>(picture_->width());
      ImGui::Image(picture_->imgui_id(), {width, height});
      ImGui::SameLine();
    }
    ImGui::BeginGroup();
    for (const SequenceFact& fact : seen_->facts) {
      ImGui::PushFont(frame.fonts.small);
      ImGui::TextColored(dim, "%s", fact.name.c_str());
      ImGui::PopFont();
      ImGui::TextWrapped("%s", fact.value.c_str());
    }
    ImGui::EndGroup();
    for (const Finding& finding : seen_->findings) {
      ImGui::TextColored(to_vec4(role_colour(Role::kWarning, frame.theme.name)), "%s", icons::kWarning);
      ImGui::SameLine();
      ImGui::TextWrapped("%s", finding.sentence.c_str());
    }
  }
}

void OpenDialog::draw_reading(const UiFrame& frame) {
  std::vector<std::string> cameras, conventions, names;
  for (const Camera& camera : known_cameras()) cameras.push_back(camera.name);
  for (const PoseConvention convention : other_conventions()) conventions.emplace_back(to_string(convention));
  int method = 0;
  for (const MethodInfo& info : methods()) {
    names.push_back(info.name);
    if (info.name == method_) method = static_cast<int>(names.size());
  }
  ImGui::PushItemWidth(180.0F * frame.scale);
  (void)choose_from("Camera", "as it is found", cameras, camera_);
  (void)ImGui::InputDouble("Depth units a metre", &depth_scale_, 0.0, 0.0,
                           depth_scale_ > 0 ? "%g" : "as the camera's");
  depth_scale_ = std::clamp(depth_scale_, 0.0, 1e6);
  (void)choose_from("Ground truth's poses", "as written", conventions, truth_);
  if (ImGui::InputInt("Frames, 0 for all", &frames_, 0)) frames_ = std::clamp(frames_, 0, 10'000'000);
  ImGui::Checkbox("White in masks is what stands still", &inverted_masks_);
  if (choose_from("Method", "as the config's", names, method))
    method_ = method == 0 ? "" : names[static_cast<std::size_t>(method - 1)];
  ImGui::PopItemWidth();
}

}  // namespace stillpoint
