#include "ui/plot/plot_file.hpp"

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <regex>

#include "core/error.hpp"
#include "core/evaluation/tables.hpp"
#include "core/out_folder.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

constexpr double kWidth = 460.0, kHeight = 260.0;  // pt: across a page, in the shape of the paper's figures
constexpr double kText = 9.0, kLine = 12.0;        // pt
constexpr double kPngScale = 3.0;                  // px a pt
constexpr Rgb kInk{51, 51, 51};

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

/// The interface's own font, so that a figure looks alike on every machine.
class FigureFont {
 public:
  FigureFont() {
    const FontBytes bytes = text_font();
    if (FT_Init_FreeType(&library_) != 0) throw std::runtime_error("FreeType cannot be started");
    if (FT_New_Memory_Face(library_, bytes.begin, static_cast<FT_Long>(bytes.size), 0, &face_) != 0)
      throw std::runtime_error("the interface's font cannot be read");
    font_ = cairo_ft_font_face_create_for_ft_face(face_, 0);
  }
  // Surfaces keep the font until they are gone, so it stays as long as the program.
  [[nodiscard]] cairo_font_face_t* get() const { return font_; }

 private:
  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
  cairo_font_face_t* font_ = nullptr;
};

cairo_font_face_t* figure_font() {
  static const FigureFont* const font = new FigureFont;
  return font->get();
}

/// A colour that was chosen for a dark ground or a light one, as it reads on white.
Rgb on_paper(Rgb colour) {
  constexpr double kBrightest = 0.62 * 255.0;  // of luminance: brighter lines vanish on white paper
  const double luminance = 0.2126 * colour.r + 0.7152 * colour.g + 0.0722 * colour.b;
  const double factor = std::min(1.0, kBrightest / std::max(1.0, luminance));
  const auto darker = [factor](std::uint8_t channel) { return static_cast<std::uint8_t>(factor * channel); };
  return {darker(colour.r), darker(colour.g), darker(colour.b)};
}

std::string named(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : label.empty() ? unit : fmt::format("{} ({})", label, unit);
}

/// Draws a figure, pt from its upper left corner.
class FigurePaint {
 public:
  FigurePaint(cairo_t& context, const PlotFigure& figure)
      : cairo_(context), plot_(figure.plot()), axes_(figure.axes()) {
    cairo_set_font_face(&cairo_, figure_font());
    cairo_set_font_size(&cairo_, kText);
    y_.range = axes_.y, y_.scale = axes_.y_scale;
    x_.range = axes_.x;
    // As many rows as the legend needs stand above the axes, and one for the axis' name.
    const double legend_rows = lay_out_legend(false);
    top_ = 8.0 + kLine * (legend_rows + (plot_.y_label.empty() ? 0.0 : 1.0));
    bottom_ = kHeight - 8.0 - kLine * (plot_.x_label.empty() ? 1.0 : 2.2);
    y_.pixel_low = bottom_, y_.pixel_high = top_;
    set_ticks();
    // The room that ticks take depends on the ranges, and these on the room: twice is close enough.
    for (int pass = 0; plot_.equal_scale && pass < 2; ++pass) equalise(), set_ticks();
  }

  void draw() {
    colour({255, 255, 255});
    cairo_paint(&cairo_);
    draw_axes();
    cairo_save(&cairo_);
    cairo_rectangle(&cairo_, left_, top_, right_ - left_, bottom_ - top_);
    cairo_clip(&cairo_);
    for (const PlotBand& band : plot_.bands) draw_band(band);
    for (const PlotSeries& series : plot_.series) draw_series(series);
    for (const PlotLevel& level : plot_.levels) draw_level(level, false);
    for (const PlotLevel& mark : plot_.marks) draw_level(mark, true);
    cairo_restore(&cairo_);
    (void)lay_out_legend(true);
  }

 private:
  void set_ticks() {
    constexpr int kMostTicksY = 6, kMostTicksX = 9;  // labels: they keep apart
    y_ticks_ =
        y_.scale == AxisScale::kLog ? log_ticks(y_.range, kMostTicksY) : linear_ticks(y_.range, kMostTicksY);
    double widest = 0.0;
    for (const AxisTick& tick : y_ticks_) widest = std::max(widest, width_of(tick.label));
    left_ = 8.0 + widest + 5.0, right_ = kWidth - 12.0;
    x_.pixel_low = left_, x_.pixel_high = right_;
    x_ticks_ = linear_ticks(x_.range, kMostTicksX);
  }

  /// Widens the axis that has more room than its range needs.
  void equalise() {
    const double x_unit = (right_ - left_) / x_.range.span(), y_unit = (bottom_ - top_) / y_.range.span();
    const auto widened = [](const AxisRange& range, double factor) {
      const double middle = 0.5 * (range.low + range.high), half = 0.5 * factor * range.span();
      return AxisRange{middle - half, middle + half};
    };
    if (x_unit > y_unit)
      x_.range = widened(x_.range, x_unit / y_unit);
    else
      y_.range = widened(y_.range, y_unit / x_unit);
  }

  void colour(Rgb c, double opacity = 1.0) const {
    cairo_set_source_rgba(&cairo_, c.r / 255.0, c.g / 255.0, c.b / 255.0, opacity);
  }

  [[nodiscard]] double width_of(const std::string& words) const {
    cairo_text_extents_t extents;
    cairo_text_extents(&cairo_, words.c_str(), &extents);
    return extents.x_advance;
  }

  void text(double x, double baseline, const std::string& words) const {
    cairo_move_to(&cairo_, x, baseline);
    cairo_show_text(&cairo_, words.c_str());
  }

  void line(double x0, double y0, double x1, double y1, double width) const {
    cairo_set_line_width(&cairo_, width);
    cairo_move_to(&cairo_, x0, y0);
    cairo_line_to(&cairo_, x1, y1);
    cairo_stroke(&cairo_);
  }

  void dash(SeriesStyle style) const {
    // Drawn and left out in turn, pt.
    static constexpr double kDashes[] = {5.0, 3.0}, kDots[] = {1.2, 2.6}, kDashDots[] = {7.0, 2.6, 1.2, 2.6};
    if (style == SeriesStyle::kDashed) cairo_set_dash(&cairo_, kDashes, 2, 0.0);
    if (style == SeriesStyle::kDotted) cairo_set_dash(&cairo_, kDots, 2, 0.0);
    if (style == SeriesStyle::kDashDot) cairo_set_dash(&cairo_, kDashDots, 4, 0.0);
  }

  void draw_axes() const {
    constexpr Rgb kGrid{222, 222, 222};
    for (const AxisTick& tick : y_ticks_) {
      const double at = y_.to_pixel(tick.value);
      colour(kGrid), line(left_, at, right_, at, tick.major ? 0.6 : 0.3);
      colour(kInk), text(left_ - 5.0 - width_of(tick.label), at + 0.35 * kText, tick.label);
    }
    for (const AxisTick& tick : x_ticks_) {
      const double at = x_.to_pixel(tick.value), width = width_of(tick.label);
      colour(kGrid), line(at, top_, at, bottom_, 0.6);
      colour(kInk), text(std::min(at - 0.5 * width, kWidth - 2.0 - width), bottom_ + kLine, tick.label);
    }
    colour(kInk);
    cairo_set_line_width(&cairo_, 0.8);
    cairo_rectangle(&cairo_, left_, top_, right_ - left_, bottom_ - top_);
    cairo_stroke(&cairo_);
    const std::string x_name = named(plot_.x_label, plot_.x_unit),
                      y_name = named(plot_.y_label, plot_.y_unit);
    text(0.5 * (left_ + right_ - width_of(x_name)), bottom_ + 2.1 * kLine, x_name);
    text(8.0, top_ - 5.0, y_name);
  }

  void draw_band(const PlotBand& band) const {
    const double from = x_.to_pixel(band.x.low);
    colour(on_paper(band.colour), static_cast<double>(band.opacity));
    cairo_rectangle(&cairo_, from, top_, std::max(1.0, x_.to_pixel(band.x.high) - from), bottom_ - top_);
    cairo_fill(&cairo_);
  }

  void draw_series(const PlotSeries& series) const {
    colour(on_paper(series.colour));
    cairo_save(&cairo_);
    cairo_set_line_width(&cairo_, 0.7 * static_cast<double>(series.width_px));
    cairo_set_line_join(&cairo_, CAIRO_LINE_JOIN_ROUND);
    dash(series.style);
    bool joined = false;
    double last_y = 0.0;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const double x = x_.to_pixel(series.x[i]), y = y_.to_pixel(series.y[i]);
      if (!std::isfinite(x) || !std::isfinite(y)) {
        joined = false;
        continue;
      }
      const bool alone =
          !joined && (i + 1 == series.x.size() || !std::isfinite(y_.to_pixel(series.y[i + 1])));
      if (series.style == SeriesStyle::kBars) {
        bar(series, i, x, y);
      } else if (series.style == SeriesStyle::kDots || alone) {
        cairo_new_sub_path(&cairo_);
        cairo_arc(&cairo_, x, y, 1.4, 0.0, 6.283185307179586);
        cairo_fill(&cairo_);
      } else if (joined) {
        if (series.style == SeriesStyle::kSteps) cairo_line_to(&cairo_, x, last_y);
        cairo_line_to(&cairo_, x, y);
      } else {
        cairo_move_to(&cairo_, x, y);
      }
      joined = true, last_y = y;
    }
    cairo_stroke(&cairo_);
    cairo_restore(&cairo_);
  }

  /// A bar reaches to the next value; the last is as wide as the one before.
  void bar(const PlotSeries& series, std::size_t i, double x, double y) const {
    const double step = i + 1 < series.x.size() ? series.x[i + 1] - series.x[i]
                        : i > 0                 ? series.x[i] - series.x[i - 1]
                                                : 1.0;
    cairo_rectangle(&cairo_, x, y, std::max(0.5, x_.to_pixel(series.x[i] + step) - x), bottom_ - y);
    cairo_fill(&cairo_);
  }

  void draw_level(const PlotLevel& level, bool upright) const {
    const double at = upright ? x_.to_pixel(level.value) : y_.to_pixel(level.value);
    if (!std::isfinite(at)) return;
    colour(on_paper(level.colour));
    cairo_save(&cairo_);
    dash(SeriesStyle::kDashed);
    if (upright)
      line(at, top_, at, bottom_, 0.8);
    else
      line(left_, at, right_, at, 0.8);
    cairo_restore(&cairo_);
    text(upright ? at + 3.0 : left_ + 4.0, upright ? top_ + kLine : at - 3.0, level.name);
  }

  /// @returns rows taken
  double lay_out_legend(bool draws) const {
    if (!plot_.legend) return 0.0;
    constexpr double kSwatch = 16.0, kGap = 14.0;  // pt: a line before a name, and between two of these
    double x = 8.0, row = 0.0;
    bool any = false;
    for (const PlotSeries& series : plot_.series) {
      if (series.name.empty()) continue;
      const double width = kSwatch + 4.0 + width_of(series.name);
      if (any && x + width > kWidth - 8.0) x = 8.0, row += 1.0;
      any = true;
      if (draws) {
        const double middle = 8.0 + kLine * row + 0.5 * kText;
        colour(on_paper(series.colour));
        cairo_save(&cairo_);
        dash(series.style);
        line(x, middle, x + kSwatch, middle, series.style == SeriesStyle::kBars ? 6.0 : 1.6);
        cairo_restore(&cairo_);
        colour(kInk);
        text(x + kSwatch + 4.0, middle + 0.35 * kText, series.name);
      }
      x += width + kGap;
    }
    return any ? row + 1.0 : 0.0;
  }

  cairo_t& cairo_;
  const Plot& plot_;
  const PlotAxes& axes_;
  AxisMap x_, y_;
  std::vector<AxisTick> x_ticks_, y_ticks_;
  double left_ = 0.0, right_ = 0.0, top_ = 0.0, bottom_ = 0.0;
};

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string plot_drawn(const PlotFigure& figure, const std::string& ending) {
  std::string bytes;
  const bool png = ending == ".png";
  const Surface surface(
      ending == ".svg" ? cairo_svg_surface_create_for_stream(append, &bytes, kWidth, kHeight)
      : ending == ".pdf"
          ? cairo_pdf_surface_create_for_stream(append, &bytes, kWidth, kHeight)
          : cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(kPngScale * kWidth),
                                       static_cast<int>(kPngScale * kHeight)),
      cairo_surface_destroy);
  // The day it was made would be the only difference between two of the same plot.
  if (ending == ".pdf")
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
  {
    const Context context(cairo_create(surface.get()), cairo_destroy);
    if (png) cairo_scale(context.get(), kPngScale, kPngScale);
    FigurePaint(*context, figure).draw();
    if (const auto status = cairo_status(context.get()); status != CAIRO_STATUS_SUCCESS)
      throw InputError(fmt::format("the plot cannot be drawn: {}", cairo_status_to_string(status)));
  }
  if (png) cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  cairo_surface_finish(surface.get());
  // Cairo numbers what it draws on from the program's start.
  return ending == ".svg" ? std::regex_replace(bytes, std::regex("id=\"surface[0-9]+\""), "id=\"plot\"")
                          : bytes;
}

PlotFigure::PlotFigure(const Plot& plot, const PlotView& view) : plot_(plot), axes_(axes_of(plot, view)) {
  values_.reserve(2 * plot.series.size());
  for (PlotSeries& series : plot_.series) {
    values_.emplace_back(series.x.begin(), series.x.end());
    series.x = values_.back();
    values_.emplace_back(series.y.begin(), series.y.end());
    series.y = values_.back();
  }
}

std::string plot_values(const PlotFigure& figure) {
  const Plot& plot = figure.plot();
  Table table{{"series", named(plot.x_label, plot.x_unit), named(plot.y_label, plot.y_unit)}, {}};
  for (const PlotSeries& series : plot.series)
    for (std::size_t i = 0; i < series.x.size(); ++i)
      table.rows.push_back({series.name, fmt::format("{}", series.x[i]),
                            std::isfinite(series.y[i]) ? fmt::format("{}", series.y[i]) : std::string()});
  return to_csv(table);
}

void write_plot(const PlotFigure& figure, const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".csv")
    write_text_file(path, plot_values(figure));
  else if (ending == ".svg" || ending == ".pdf" || ending == ".png")
    write_text_file(path, plot_drawn(figure, ending));
  else
    throw InputError(fmt::format("{}: a plot is written as {}", path, kPlotEndings));
}

}  // namespace stillpoint
