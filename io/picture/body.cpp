#include "io/picture/body.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkContourFilter.h>
#include <vtkDoubleArray.h>
#include <vtkLight.h>
#include <vtkLookupTable.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

namespace chladni::picture {
namespace {

vtkNew<vtkPoints> points_of(const Points& points) {
  vtkNew<vtkPoints> result;
  result->SetDataTypeToDouble();
  for (const auto row : points.rowwise()) result->InsertNextPoint(row(0), row(1), row(2));
  return result;
}

vtkNew<vtkCellArray> cells_of(const Cells& cells) {
  vtkNew<vtkCellArray> result;
  for (const auto row : cells.rowwise()) {
    result->InsertNextCell(static_cast<int>(row.size()));
    for (const std::int32_t point : row) result->InsertCellPoint(point);
  }
  return result;
}

vtkNew<vtkPolyData> skin_of(const Body& body, const Points& points, const Eigen::VectorXd& value) {
  vtkNew<vtkPolyData> skin;
  skin->SetPoints(points_of(points));
  skin->SetPolys(cells_of(body.triangles));
  vtkNew<vtkDoubleArray> values;
  for (const double v : value) values->InsertNextValue(v);
  skin->GetPointData()->SetScalars(values);
  return skin;
}

vtkNew<vtkLookupTable> diverging_table() {
  constexpr int count = 511;  // odd: one entry is white
  vtkNew<vtkLookupTable> table;
  table->SetNumberOfTableValues(count);
  table->SetRange(-1.0, 1.0);
  for (int i = 0; i < count; ++i) {
    const Colour colour = io::diverging(2.0 * i / (count - 1) - 1.0);
    table->SetTableValue(i, colour[0], colour[1], colour[2], 1.0);
  }
  return table;
}

void add_lines(vtkRenderer* panel, vtkPolyData* lines, const Colour& colour, float width) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(lines);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->SetLineWidth(width);
  actor->GetProperty()->LightingOff();
  panel->AddActor(actor);
}

vtkNew<vtkPolyData> outline_of(const Body& body, const Points& points) {
  vtkNew<vtkPolyData> lines;
  lines->SetPoints(points_of(points));
  lines->SetLines(cells_of(body.outline));
  return lines;
}

}  // namespace

void add_skin(vtkRenderer* panel, const Body& body, const Points& points,
              const Eigen::VectorXd& value) {
  vtkNew<vtkPolyDataNormals> normals;  // smooth within faces, sharp at edges
  normals->SetInputData(skin_of(body, points, value));
  normals->SetFeatureAngle(30.0);
  normals->ConsistencyOff();
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(normals->GetOutputPort());
  mapper->SetLookupTable(diverging_table());
  mapper->SetScalarRange(-1.0, 1.0);
  mapper->InterpolateScalarsBeforeMappingOn();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.50);
  actor->GetProperty()->SetDiffuse(0.54);
  actor->GetProperty()->SetSpecular(0.0);
  panel->AddActor(actor);
  add_lines(panel, outline_of(body, points), {0.30, 0.31, 0.34}, 2.0F);
}

void add_ghost(vtkRenderer* panel, const Body& body, const Points& points, const io::View& view) {
  const Eigen::RowVector3d back = -1.5 * body.diagonal * view.axes.row(2);
  const Eigen::RowVector3d hair = 2e-3 * body.diagonal * view.axes.row(2);
  const Points behind = points.rowwise() + back;
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(skin_of(body, behind, Eigen::VectorXd::Zero(points.rows())));
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(1.0, 1.0, 1.0);
  actor->GetProperty()->LightingOff();
  panel->AddActor(actor);
  add_lines(panel, outline_of(body, behind.rowwise() + hair), kPale, 1.6F);
}

void add_zero_lines(vtkRenderer* panel, const Body& body, const Points& points,
                    const Eigen::VectorXd& value, const io::View& view, const Colour& colour,
                    float width) {
  const Eigen::VectorXd clean =
      value.unaryExpr([](double v) { return std::abs(v) < 1e-6 ? 1e-6 : v; });
  vtkNew<vtkContourFilter> contour;
  contour->SetInputData(skin_of(body, points, clean));
  contour->SetValue(0, 0.0);
  contour->ComputeScalarsOff();
  contour->Update();
  vtkPolyData* lines = contour->GetOutput();
  // The lines lie slightly in front of the skin, so that the skin does not hide them.
  const Eigen::Vector3d hair = 2e-3 * body.diagonal * view.axes.row(2).transpose();
  for (vtkIdType i = 0; i < lines->GetNumberOfPoints(); ++i) {
    Eigen::Vector3d at;
    lines->GetPoint(i, at.data());
    at += hair;
    lines->GetPoints()->SetPoint(i, at.data());
  }
  add_lines(panel, lines, colour, width);
}

void add_map(vtkRenderer* panel, const Body& body, const Eigen::VectorXd& value) {
  constexpr int count = 64;  // the bands are too fine to see and make the file a third as long
  vtkNew<vtkLookupTable> table;
  table->SetNumberOfTableValues(count);
  table->SetRange(0.0, 1.0);
  for (int i = 0; i < count; ++i) {
    const Colour colour = io::sequential(static_cast<double>(i) / (count - 1));
    table->SetTableValue(i, colour[0], colour[1], colour[2], 1.0);
  }
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(skin_of(body, body.points, value));
  mapper->SetLookupTable(table);
  mapper->SetScalarRange(0.0, 1.0);
  mapper->InterpolateScalarsBeforeMappingOn();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  panel->AddActor(actor);
}

void add_parts(vtkRenderer* panel, const Body& body, const Cells& colour) {
  auto skin = skin_of(body, body.points, Eigen::VectorXd::Zero(body.points.rows()));
  skin->GetPointData()->SetScalars(nullptr);
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(3);
  for (const auto number : colour.reshaped()) {
    for (const double part : io::categorical(number)) {
      colours->InsertNextValue(static_cast<unsigned char>(std::lround(255.0 * part)));
    }
  }
  skin->GetCellData()->SetScalars(colours);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(skin);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetInterpolationToFlat();
  actor->GetProperty()->SetAmbient(0.86);
  actor->GetProperty()->SetDiffuse(0.16);
  actor->GetProperty()->SetSpecular(0.0);
  panel->AddActor(actor);
  add_lines(panel, outline_of(body, body.points), {0.30, 0.31, 0.34}, 2.0F);
}

void add_plain(vtkRenderer* panel, const Body& body, const Colour& colour) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(skin_of(body, body.points, Eigen::VectorXd::Zero(body.points.rows())));
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
  actor->GetProperty()->LightingOff();
  panel->AddActor(actor);
}

void look(vtkRenderer* panel, const io::View& view, double height, double diagonal) {
  const Eigen::Vector3d eye = view.centre + 3.0 * diagonal * view.axes.row(2).transpose();
  vtkCamera* camera = panel->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(view.centre.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(view.axes(1, 0), view.axes(1, 1), view.axes(1, 2));
  camera->SetParallelScale(0.5 * height / view.pixels_per_metre);
  camera->SetClippingRange(0.5 * diagonal, 7.0 * diagonal);
  vtkNew<vtkLight> lamp;  // from the upper left, a little in front
  lamp->SetLightTypeToCameraLight();
  lamp->SetPosition(-0.45, 0.7, 1.0);
  lamp->SetFocalPoint(0.0, 0.0, 0.0);
  panel->AddLight(lamp);
}

}  // namespace chladni::picture
