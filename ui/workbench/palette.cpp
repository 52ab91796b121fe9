// The palette: whatever can be done, found by its name.
#include "ui/workbench/palette.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <utility>

#include "core/motion/methods.hpp"
#include "ui/panels/parameter_rows.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

std::string lowered(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  for (const char letter : lowered(text) + " ") {
    if (letter != ' ') {
      word += letter;
    } else if (!word.empty()) {
      words.push_back(std::move(word));
      word.clear();
    }
  }
  return words;
}

/// Higher is better; nothing where it does not fit.
std::optional<int> row_score(const PaletteRow& row, std::string_view query) {
  // Far apart, so that no sum of letters reaches the next.
  constexpr int kInTitle = 2'000'000, kInWords = 1'000'000;
  const std::vector<std::string> wanted = words_of(query);
  const std::string title = lowered(row.title), all = title + ' ' + lowered(row.words);
  const auto holds = [&](const std::string& text) {
    return std::all_of(wanted.begin(), wanted.end(),
                       [&](const std::string& word) { return text.find(word) != std::string::npos; });
  };
  const std::optional<int> letters = match_score(row.title, query);
  if (holds(title)) return kInTitle + letters.value_or(0);
  if (holds(all)) return kInWords + letters.value_or(0);
  return letters;
}

/// A row: icon, title, and at the right its key, or why it cannot be done. @returns whether it was clicked
bool draw_palette_row(const UiFrame& frame, const PaletteRow& row, bool chosen) {
  ImGui::PushID(row.title.c_str());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, gap = 4.0F * frame.scale, left = 30.0F * frame.scale;
  const bool clicked = ImGui::Selectable("##row", chosen, 0, {width, 1.35F * ImGui::GetFontSize()});
  if (chosen && (is_key_pressed(Key::kDown, true) || is_key_pressed(Key::kUp, true))) ImGui::SetScrollHereY();
  const float y = at.y + 0.18F * ImGui::GetFontSize();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const bool on = row.off.empty();
  list.AddText({at.x + gap, y}, to_u32(frame.theme.text_dim), row.icon.c_str());
  const float title = ImGui::CalcTextSize(row.title.c_str()).x;
  draw_clipped_text({at.x + left, y}, row.title, width - left - gap,
                    to_u32(on ? frame.theme.text : frame.theme.text_dim));
  ImGui::PushFont(on ? frame.fonts.mono : frame.fonts.small);
  const std::string& beside = on ? row.key : row.off;
  const float room = width - left - title - 4.0F * gap,
              wide = std::min(ImGui::CalcTextSize(beside.c_str()).x, std::max(room, 0.0F));
  draw_clipped_text({at.x + width - wide - gap, y}, beside, wide, to_u32(frame.theme.text_dim));
  ImGui::PopFont();
  if (!on && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.off.c_str());
  ImGui::PopID();
  return clicked;
}

}  // namespace

std::vector<PaletteRow> found_rows(std::vector<PaletteRow> rows, std::string_view query) {
  if (words_of(query).empty()) return rows;
  std::vector<std::pair<int, PaletteRow>> scored;
  for (PaletteRow& row : rows)
    if (const auto score = row_score(row, query)) scored.emplace_back(*score, std::move(row));
  std::stable_sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) {
    if (a.second.off.empty() != b.second.off.empty()) return a.second.off.empty();
    return a.first > b.first;
  });
  rows.clear();
  for (auto& [score, row] : scored) rows.push_back(std::move(row));
  return rows;
}

std::optional<int> frame_asked_for(std::string_view query) {
  const std::vector<std::string> words = words_of(query);
  if (words.empty() || words.size() > 2 || (words.size() == 2 && words.front() != "frame"))
    return std::nullopt;
  const std::string& number = words.back();
  int frame = 0;
  const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), frame);
  if (error != std::errc() || rest != number.data() + number.size() || frame < 0) return std::nullopt;
  return frame;
}

void Workbench::draw_palette() {
  if (!palette_.open) return;
  const float scale = frame_->scale, height = 420.0F * scale;
  if (palette_.opened_now) ImGui::SetNextWindowFocus();
  if (begin_overlay(*frame_, "##palette", {620.0F * scale, height}, 0.12F)) {
    // Enter takes the keyboard from the field; where it did nothing, typing goes on.
    if (std::exchange(palette_.takes_keys, false) || palette_.opened_now) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(-1.0F);
    if (ImGui::InputTextWithHint("##query", "What to do, a frame's number, a method, a preset, a parameter",
                                 palette_.query, sizeof palette_.query))
      palette_.chosen = 0;
    draw_palette_list();
  }
  const bool left = !palette_.opened_now && !ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows);
  if (left || is_key_pressed(Key::kEscape)) palette_.open = false;
  palette_.opened_now = false;
  ImGui::End();
}

void Workbench::draw_palette_list() {
  std::vector<PaletteRow> rows = found_rows(palette_rows(), palette_.query);
  const auto frame = frame_asked_for(palette_.query);
  if (frame && session_ != nullptr && can_go()) {
    const int last = session_->frame_count - 1;
    PaletteRow row{.icon = icons::kChevronRight, .title = fmt::format("Go to frame {}", *frame)};
    if (*frame > last) row.off = fmt::format("The last frame is {}.", last);
    row.run = [this, to = *frame] { go_to(to); };
    rows.insert(rows.begin(), std::move(row));
  }
  const int count = static_cast<int>(rows.size());
  if (is_key_pressed(Key::kDown, true)) ++palette_.chosen;
  if (is_key_pressed(Key::kUp, true)) --palette_.chosen;
  palette_.chosen = count == 0 ? 0 : (palette_.chosen + count) % count;
  const bool entered = is_key_pressed(Key::kEnter) || is_key_pressed(Key::kKeypadEnter);
  std::function<void()> run;
  ImGui::BeginChild("rows");
  for (int i = 0; i < count; ++i) {
    const PaletteRow& row = rows[static_cast<std::size_t>(i)];
    const bool chosen = palette_.chosen == i;
    if ((draw_palette_row(*frame_, row, chosen) || (chosen && entered)) && row.off.empty()) run = row.run;
  }
  if (count == 0) ImGui::TextDisabled("Nothing has such a name.");
  ImGui::EndChild();
  if (!run) {
    palette_.takes_keys = entered;
    return;
  }
  palette_.open = false;
  run();
}

std::vector<PaletteRow> Workbench::palette_rows() {
  std::vector<PaletteRow> rows;
  for (const Action& action : actions_.all()) {
    PaletteRow row{.icon = action.icon, .title = action.title, .key = key_text(action), .run = action.run};
    if (!is_enabled(action))
      row.off = session_ == nullptr       ? "No sequence is open."
                : why_off(action).empty() ? "Not here: what it asks for is not at hand."
                                          : why_off(action);
    rows.push_back(std::move(row));
  }
  if (session_ == nullptr || !host_.request) return rows;
  add_picture_rows(rows);
  add_run_rows(rows);
  add_parameter_rows(rows);
  return rows;
}

void Workbench::add_run_rows(std::vector<PaletteRow>& rows) {
  const Config& now = session_->config;
  for (const MethodInfo& method : methods()) {
    Config config = now;
    config.run.method = method.name;
    const std::string words = "method " + method.title + ' ' + method.citation;
    const std::string own = method.name == now.run.method ? "It is this run's." : "";
    rows.push_back({.icon = icons::kRandom,
                    .title = fmt::format("Compare with method {}", method.name),
                    .words = words,
                    .off = own,
                    .run = [this, config, name = method.name] {
                      ask(request::AddGhost{config, "method " + name, 0});
                    }});
    rows.push_back({.icon = icons::kRefresh,
                    .title = fmt::format("Run all by method {}", method.name),
                    .words = words,
                    .off = own,
                    .run = [this, config] { ask(request::RunAll{config}); }});
  }
  for (const std::string& preset : preset_names())
    rows.push_back({.icon = icons::kRandom,
                    .title = fmt::format("Compare with preset {}", preset),
                    .run = [this, preset] {
                      try {
                        ask(request::AddGhost{load_config(preset), preset, 0});
                      } catch (const std::exception& error) {
                        say(error.what(), true);
                      }
                    }});
}

void Workbench::add_parameter_rows(std::vector<PaletteRow>& rows) {
  Config config = session_->config;
  for (const Parameter& parameter : parameters(config))
    rows.push_back({.icon = icons::kSliders,
                    .title = fmt::format("Parameter {}: {}{}{}", parameter.key, value_text(parameter),
                                         parameter.unit.empty() ? "" : " ", parameter.unit),
                    .words = label_of(parameter) + ' ' + std::string(parameter.help),
                    .run = [this, key = parameter.key] { show_parameter(key); }});
}

void Workbench::show_parameter(const std::string& key) {
  constexpr const char* kPanel = "parameters";
  Panel* panel = find_panel(kPanel);
  if (panel == nullptr) return;
  panel->find(key);
  if (!contains(layout_, kPanel) || is_behind(kPanel)) after_frame_ = [this] { toggle_panel(kPanel); };
}

}  // namespace stillpoint
