// The kinds of picture. To add one, add a file, and a line in the table of painter.cpp.
#pragma once

#include <string>

#include "io/bytes/message.h"

namespace chladni::picture {

/// Deformed bodies beside each other, one per mode; PNG.
///
/// head: `title`; `panels`: list of {`title`, `note`, `axis` (0 x, 1 y, 2 z: gives the colour)};
/// `markers`: list of {`name`, `kind`}; `deformation`: largest displacement drawn, as a fraction of
/// the body's diagonal. Arrays: `points` V×3, `triangles` T×3, `outline` E×2, `shapes` V×3P (panel
/// p has columns 3p..3p+2; a length of 1 is drawn `deformation` long), `marker_vertex` M×1.
[[nodiscard]] std::string contact_sheet(const io::Message& request);

/// A surface seen along its normal, coloured by the quality of its places; PNG.
///
/// head: `title`, `scale`, `lowest`, `highest`; `lines`: names; `best`: labels; `markers`: list of
/// {`name`, `kind`}. Arrays, in the paper's frame (x right, y up, z towards the eye): `points` V×3,
/// `value` V×1, `lines` V×L, `best` B×3, `marker_places` M×3; `allowed`, `forbidden` T×3.
[[nodiscard]] std::string heat_map(const io::Message& request);

/// Layouts beside each other, each on the surface coloured by the expected values; PNG.
///
/// head: `title`, `scale`, `lightest`, `darkest`; `panels`: list of {`title`, `note`, `kinds`}.
/// Arrays, in the paper's frame: `points` V×3, `triangles` T×3, `values` V×P, `places_0`, ... M×3.
[[nodiscard]] std::string layouts(const io::Message& request);

/// A body from two sides, with coloured and named parts; PNG.
///
/// head: `title`, `panel_width`, `panel_height` [px]; `panels`: list of {`title`, `labels`: list of
/// {`words`, `size`}}; `rows`: list of {`number`, `name`, `area`, `colour`}; `more`: how many have
/// no row. Arrays: `triangles` T×3, `outline` E×2, `colours` T×1 (io/figure/colours.h,
/// categorical); per panel, in the paper's frame, `points_0`, ... V×3 and `labels_0`, ... L×2.
[[nodiscard]] std::string patches(const io::Message& request);

/// Flat shapes and words at pixel positions; PNG.
///
/// head: `width`, `height`; `shapes`: list of {`kind` (lines, polygons), `colour` (three numbers in
/// [0, 1]), `width` of lines, `paths`: how many}; `texts`: list of {`x`, `y`, `words`, `size`,
/// `colour`, `align`, `bold`, `upwards`}. Arrays: `points` N×2, `counts` M×1: of each path.
[[nodiscard]] std::string drawing(const io::Message& request);

}  // namespace chladni::picture
