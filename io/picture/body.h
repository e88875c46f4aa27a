// The body on a panel: its skin, deformed and coloured, with its edges and level lines.
#pragma once

#include <vtkRenderer.h>

#include "base/arrays.h"
#include "io/figure/view.h"
#include "io/picture/canvas.h"

namespace chladni::picture {

/// What every panel shows in another state.
struct Body {
  Points points;          ///< V×3 [m]
  Cells triangles;        ///< T×3
  Cells outline;          ///< E×2
  double diagonal = 1.0;  ///< of its bounding box [m]
};

/// The skin at `points` (V×3), coloured by `value` (V, in [−1, 1]), softly lit; the outline dark.
void add_skin(vtkRenderer* panel, const Body& body, const Points& points,
              const Eigen::VectorXd& value);
/// The outline of the body at `points`, pale, hidden edges left out, behind all else.
void add_ghost(vtkRenderer* panel, const Body& body, const Points& points, const io::View& view);
/// Lines on the skin where `value` is zero, black. Values below 1e-6 count as positive: what is
/// zero all over (up to round-off) has no nodal line.
void add_zero_lines(vtkRenderer* panel, const Body& body, const Points& points,
                    const Eigen::VectorXd& value, const io::View& view,
                    const Colour& colour = {0.0, 0.0, 0.0}, float width = 4.0F);
/// Triangles coloured by `value` (V, in [0, 1]) from dark to light, without light and shade.
void add_map(vtkRenderer* panel, const Body& body, const Eigen::VectorXd& value);
/// Triangles coloured by their number (T×1, io/figure/colours.h), softly lit; the outline dark.
void add_parts(vtkRenderer* panel, const Body& body, const Cells& colour);
/// Triangles in one colour.
void add_plain(vtkRenderer* panel, const Body& body, const Colour& colour);
/// Sets the panel's camera: `view`, centred, `height` px high.
void look(vtkRenderer* panel, const io::View& view, double height, double diagonal);

}  // namespace chladni::picture
