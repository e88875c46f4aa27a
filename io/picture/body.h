// Draws the body on a panel: its deformed and coloured skin, with edges and level lines.
#pragma once

#include <vtkRenderer.h>

#include "base/arrays.h"
#include "io/figure/view.h"
#include "io/picture/canvas.h"

namespace chladni::picture {

/// The body that every panel shows, each in another state.
struct Body {
  Points points;          ///< V×3 [m]
  Cells triangles;        ///< T×3
  Cells outline;          ///< E×2
  double diagonal = 1.0;  ///< of its bounding box [m]
};

/// Adds the skin at `points` (V×3), coloured by `value` (V, in [−1, 1]), softly lit, with a dark
/// outline.
void add_skin(vtkRenderer* panel, const Body& body, const Points& points,
              const Eigen::VectorXd& value);
/// Adds the pale outline of the body at `points`, without hidden edges, behind everything else.
void add_ghost(vtkRenderer* panel, const Body& body, const Points& points, const io::View& view);
/// Adds lines on the skin where `value` is zero (black by default). Values below 1e-6 count as
/// positive, so a field that is zero everywhere (up to round-off) has no nodal line.
void add_zero_lines(vtkRenderer* panel, const Body& body, const Points& points,
                    const Eigen::VectorXd& value, const io::View& view,
                    const Colour& colour = {0.0, 0.0, 0.0}, float width = 4.0F);
/// Adds triangles coloured by `value` (V, in [0, 1]) from dark to light, without shading.
void add_map(vtkRenderer* panel, const Body& body, const Eigen::VectorXd& value);
/// Adds triangles coloured by number (T×1, io/figure/colours.h), softly lit, with a dark outline.
void add_parts(vtkRenderer* panel, const Body& body, const Cells& colour);
/// Adds triangles in one colour.
void add_plain(vtkRenderer* panel, const Body& body, const Colour& colour);
/// Sets the panel's camera: `view`, centred, `height` px high.
void look(vtkRenderer* panel, const io::View& view, double height, double diagonal);

}  // namespace chladni::picture
