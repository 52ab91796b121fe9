#include "ui/panels/panels_shared.hpp"

#include "core/inspect/scene_point.hpp"
#include "ui/session/session_view.hpp"

namespace stillpoint {

const PairGeometry& PanelsShared::geometry(const SessionView& session) {
  constexpr std::size_t kKept = 8;  // runs that may be drawn side by side
  const auto same = [](const auto& weak, const auto& strong) {
    return !weak.owner_before(strong) && !strong.owner_before(weak);
  };
  for (const KeptGeometry& kept : geometries_)
    if (same(kept.current, session.current) && same(kept.run, session.run)) return *kept.geometry;
  geometries_.push_front(
      {std::make_shared<const PairGeometry>(pair_geometry(*session.current, *session.run, session.camera)),
       session.current, session.run});
  if (geometries_.size() > kKept) geometries_.pop_back();
  return *geometries_.front().geometry;
}

}  // namespace stillpoint
