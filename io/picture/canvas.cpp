#include "io/picture/canvas.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCoordinate.h>
#include <vtkImageData.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkPNGWriter.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkTextureObject.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>

#include "base/error.h"
#include "io/picture/letters.h"
#include "io/picture_file.h"

namespace chladni::picture {
namespace {

constexpr int kFiner = 2;  // the picture is painted larger by this factor
// [px] Mesa paints twice that; a larger window stays black.
constexpr int kLongest = static_cast<int>(io::kLongestPicture);

void require_size(int width, int height, int longest) {
  require(std::min(width, height) >= 1 && std::max(width, height) <= longest,
          "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
              " px, expected 1 to " + std::to_string(longest));
}

void set_colour(vtkProperty2D* property, const Colour& colour) {
  property->SetColor(colour[0], colour[1], colour[2]);
}

// The mean of each kFiner x kFiner block of pixels, rounded to steps of 5. The eye does not see
// these steps, and the file is a third smaller.
vtkNew<vtkImageData> averaged(vtkImageData* fine, int width, int height) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(width, height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  const auto* from = static_cast<const unsigned char*>(fine->GetScalarPointer());
  auto* to = static_cast<unsigned char*>(image->GetScalarPointer());
  const int row = 3 * kFiner * width;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const unsigned char* block = from + kFiner * (y * row + 3 * x);
      for (int c = 0; c < 3; ++c) {
        const int sum = block[c] + block[c + 3] + block[c + row] + block[c + row + 3];
        *to++ = static_cast<unsigned char>((sum + 10) / 20 * 5);
      }
    }
  }
  return image;
}

void set_style(vtkTextActor* actor, const TextStyle& style) {
  vtkTextProperty* text = actor->GetTextProperty();
  text->SetFontFamilyToArial();
  text->SetFontSize(static_cast<int>(kFiner * style.size));
  text->SetBold(style.bold ? 1 : 0);
  text->SetColor(style.colour[0], style.colour[1], style.colour[2]);
  text->SetVerticalJustificationToBottom();
  if (style.upwards) text->SetOrientation(90.0);
  if (style.align == TextStyle::Align::centre) text->SetJustificationToCentered();
  if (style.align == TextStyle::Align::right) text->SetJustificationToRight();
}

}  // namespace

Canvas::Canvas(int width, int height) : width_(width), height_(height) {
  require_size(width, height, kLongest);
  window_->SetOffScreenRendering(1);
  window_->SetMultiSamples(0);
  window_->SetSize(kFiner * width, kFiner * height);
  window_->SetNumberOfLayers(2);
  vtkNew<vtkRenderer> back;
  back->SetBackground(1.0, 1.0, 1.0);
  window_->AddRenderer(back);
  front_->SetLayer(1);
  front_->InteractiveOff();
  window_->AddRenderer(front_);
}

vtkRenderer* Canvas::panel(const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
  vtkNew<vtkRenderer> panel;
  panel->SetBackground(1.0, 1.0, 1.0);
  panel->SetViewport(corner.x() / width_, 1.0 - (corner.y() + size.y()) / height_,
                     (corner.x() + size.x()) / width_, 1.0 - corner.y() / height_);
  window_->AddRenderer(panel);
  return panel;
}

void Canvas::text(const Eigen::Vector2d& at, const std::string& words, const TextStyle& style) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(known_letters(words).c_str());
  set_style(actor, style);
  actor->SetDisplayPosition(static_cast<int>(kFiner * at.x()),
                            static_cast<int>(kFiner * (height_ - at.y())));
  front_->AddActor2D(actor);
}

double Canvas::text_width(const std::string& words, const TextStyle& style) {
  return measured(known_letters(words), style);
}

// A letter that the font lacks takes no room between two others.
std::string Canvas::known_letters(const std::string& words) {
  return paintable(words, [&](std::string_view letter) {
    const auto known = has_letter_.find(letter);
    if (known != has_letter_.end()) return known->second;
    const std::string one(letter);
    const bool has = measured("H" + one + "H", {}) > measured("HH", {});
    return has_letter_.emplace(one, has).first->second;
  });
}

double Canvas::measured(const std::string& words, const TextStyle& style) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(words.c_str());
  set_style(actor, style);
  std::array<double, 4> box{};
  actor->GetBoundingBox(front_, box.data());
  return (box[1] - box[0]) / kFiner;
}

void Canvas::polygon(const std::vector<Eigen::Vector2d>& corners, const Colour& fill,
                     const Colour& border, double line) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> face, edge;
  const auto count = static_cast<vtkIdType>(corners.size());
  face->InsertNextCell(static_cast<int>(count));
  edge->InsertNextCell(static_cast<int>(count + 1));
  for (vtkIdType i = 0; i <= count; ++i) {
    const Eigen::Vector2d& corner = corners[static_cast<std::size_t>(i % count)];
    if (i < count) {
      points->InsertNextPoint(kFiner * corner.x(), kFiner * (height_ - corner.y()), 0.0);
      face->InsertCellPoint(i);
    }
    edge->InsertCellPoint(i % count);
  }
  const auto add = [&](vtkCellArray* faces, vtkCellArray* lines, const Colour& colour) {
    vtkNew<vtkPolyData> shape;
    shape->SetPoints(points);
    shape->SetPolys(faces);
    shape->SetLines(lines);
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(shape);
    vtkNew<vtkActor2D> actor;
    actor->SetMapper(mapper);
    set_colour(actor->GetProperty(), colour);
    actor->GetProperty()->SetLineWidth(static_cast<float>(kFiner * line));
    front_->AddActor2D(actor);
  };
  add(face, nullptr, fill);
  if (line > 0.0) add(nullptr, edge, border);
}

void Canvas::lines(const std::vector<std::vector<Eigen::Vector2d>>& paths, const Colour& colour,
                   double width) {
  add_paths(paths, colour, width, false);
}

void Canvas::polygons(const std::vector<std::vector<Eigen::Vector2d>>& paths,
                      const Colour& colour) {
  add_paths(paths, colour, 1.0, true);
}

void Canvas::add_paths(const std::vector<std::vector<Eigen::Vector2d>>& paths, const Colour& colour,
                       double width, bool filled) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  for (const auto& path : paths) {
    cells->InsertNextCell(static_cast<int>(path.size()));
    for (const auto& point : path) {
      cells->InsertCellPoint(
          points->InsertNextPoint(kFiner * point.x(), kFiner * (height_ - point.y()), 0.0));
    }
  }
  vtkNew<vtkPolyData> shape;
  shape->SetPoints(points);
  if (filled) {
    shape->SetPolys(cells);
  } else {
    shape->SetLines(cells);
  }
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(shape);
  vtkNew<vtkActor2D> actor;
  actor->SetMapper(mapper);
  set_colour(actor->GetProperty(), colour);
  actor->GetProperty()->SetLineWidth(static_cast<float>(kFiner * width));
  front_->AddActor2D(actor);
}

std::string Canvas::png() {
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window_);
  grab->SetInputBufferTypeToRGB();
  grab->ReadFrontBufferOff();
  grab->Update();
  auto* display = vtkOpenGLRenderWindow::SafeDownCast(window_);
  const int paintable = vtkTextureObject::GetMaximumTextureSize(display);
  if (paintable > 0) require_size(width_, height_, paintable / kFiner);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(averaged(grab->GetOutput(), width_, height_));
  writer->SetCompressionLevel(6);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
          static_cast<std::size_t>(bytes->GetNumberOfValues())};
}

}  // namespace chladni::picture
