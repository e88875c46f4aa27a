// Pictures of a matrix as coloured squares with its numbers, for a MAC or errors over channels.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/picture_file.h"

namespace chladni::io {

struct MatrixPicture {
  std::string title;
  std::string row_label, column_label;     ///< meaning of rows and columns
  std::vector<std::string> rows, columns;  ///< names, one each
  Eigen::MatrixXd value;                   ///< NaN gives an empty square
  double light = 0.0, dark = 1.0;          ///< values of the lightest and the darkest colour
  int decimals = 2;                        ///< of the numbers in the squares (where they fit)
};

/// PNG, 1000 px wide or 1400 for more than 24 columns (wider where long names leave no room), and
/// its squares 6000 px high at most; the same input gives the same bytes.
/// @throws InvalidInput  names and values differ in number, no value, more than 200 rows or
/// columns;
///                       on paper, the names leave no room at this width (says which does), or a
///                       PNG would be too large
/// @throws WorkerDied    as draw_modes
void draw_matrix(const PictureFile& png, const MatrixPicture& picture);

}  // namespace chladni::io
