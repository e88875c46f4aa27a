#include "fem/attachment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <map>

#include "base/error.h"
#include "fem/assemble.h"
#include "field_on_plate.h"

namespace chladni::fem {
namespace {

Eigen::VectorXd on_nodes(const mesh::TetMesh& body, const Field& field) {
  Eigen::VectorXd u(3 * body.node_count());
  for (Eigen::Index i = 0; i < body.node_count(); ++i) {
    u.segment<3>(3 * i) = field(body.points.row(i).transpose());
  }
  return u;
}

// The field on the nodes, then on the degrees of freedom that attachments brought.
Eigen::VectorXd on_all(const mesh::TetMesh& body, const AttachmentTerms& t, const Field& field) {
  Eigen::VectorXd u(3 * body.node_count() + t.extra_count());
  u.head(3 * body.node_count()) = on_nodes(body, field);
  for (Eigen::Index i = 0; i < t.extra_count(); ++i) {
    const auto& extra = t.extras[static_cast<std::size_t>(i)];
    u(3 * body.node_count() + i) = extra.direction.dot(field(extra.position));
  }
  return u;
}

// uᵀ A u.
double quadratic(const std::vector<Eigen::Triplet<double>>& lower, const Eigen::VectorXd& u) {
  double sum = 0.0;
  for (const auto& t : lower) {
    EXPECT_GE(t.row(), t.col());
    sum += (t.row() == t.col() ? 1.0 : 2.0) * t.value() * u(t.row()) * u(t.col());
  }
  return sum;
}

// What rounding may leave of uᵀ A u where it should be zero.
double rounding(const std::vector<Eigen::Triplet<double>>& lower, const Eigen::VectorXd& u) {
  double sum = 0.0;
  for (const auto& t : lower) sum += 2.0 * std::abs(t.value() * u(t.row()) * u(t.col()));
  return 1e-13 * sum;
}

Field translation(const Eigen::Vector3d& by) {
  return [by](const Eigen::Vector3d&) { return by; };
}
Field rotation(const Eigen::Vector3d& angle, const Eigen::Vector3d& about) {
  return [=](const Eigen::Vector3d& x) { return angle.cross(Eigen::Vector3d(x - about)); };
}

const Eigen::Vector3d kAngle(0.3, -0.5, 0.8);
const Eigen::Vector3d kElsewhere(0.4, -0.1, 0.2);

// One of each kind, oblique, at points or with footprints (one of which hangs over two edges).
std::vector<Attachment> one_of_each(const mesh::TetMesh& body, double footprint) {
  const auto site = site_on(body, 0.04, -0.03);
  const auto corner = site_on(body, -0.14, 0.09);
  const Eigen::Vector3d d = Eigen::Vector3d(1.0, -2.0, 2.0) / 3.0;
  Eigen::Matrix3d inertia;
  inertia << 3e-4, 1e-5, 0.0, 1e-5, 2e-4, -2e-5, 0.0, -2e-5, 4e-4;
  return {
      {"mass", site, footprint, PointMass{.mass = 0.2, .inertia = inertia}},
      {"spring", corner, footprint, GroundSpring{.direction = d, .stiffness = 2e5, .damping = 3.0}},
      {"torsion", site, footprint,
       GroundTorsionSpring{.axis = d, .stiffness = 40.0, .damping = 0.1}},
      {"link", site, footprint, LinkSpring{corner, Eigen::Vector3d::Zero(), 5e4, 2.0}},
      {"shear link", site, footprint, LinkSpring{corner, d, 7e4, 1.0}},
      {"resonator", corner, footprint, Resonator{d, 0.05, 1e5, 4.0}}};
}

std::vector<Attachment> only(const std::vector<Attachment>& all, const std::string& name) {
  for (const auto& a : all) {
    if (a.name == name) return {a};
  }
  return {};
}

class AttachmentOn : public ::testing::TestWithParam<std::tuple<int, double>> {
 protected:
  mesh::TetMesh body_ = plate(std::get<0>(GetParam()));
  std::vector<Attachment> all_ = one_of_each(body_, std::get<1>(GetParam()));
  AttachmentTerms of(const std::string& name) const { return terms(body_, only(all_, name)); }
};

TEST_P(AttachmentOn, MassesWeighTheSameAlongEveryAxis) {
  for (const auto& [name, mass] : {std::pair{"mass", 0.2}, std::pair{"resonator", 0.05}}) {
    const auto t = of(name);
    for (int axis = 0; axis < 3; ++axis) {
      const auto u = on_all(body_, t, translation(Eigen::Vector3d::Unit(axis)));
      EXPECT_NEAR(quadratic(t.mass, u), mass, 1e-12) << name << " along " << axis;
    }
  }
}

TEST_P(AttachmentOn, MassesTurnAsRigidBodiesDo) {
  for (const std::string name : {"mass", "resonator"}) {
    const auto t = of(name);
    const auto a = only(all_, name).front();
    const auto u = on_all(body_, t, rotation(kAngle, kElsewhere));
    const Eigen::Vector3d move = kAngle.cross(Eigen::Vector3d(a.site.position - kElsewhere));
    const auto* mass = std::get_if<PointMass>(&a.what);
    const double expected =
        mass != nullptr ? mass->mass * move.squaredNorm() + kAngle.dot(mass->inertia * kAngle)
                        : 0.05 * move.squaredNorm();
    EXPECT_NEAR(quadratic(t.mass, u), expected, 1e-10 * expected) << name;
  }
}

TEST_P(AttachmentOn, GroundSpringsFeelTheRigidMotionOfTheirSite) {
  const auto t = of("spring");
  const auto a = only(all_, "spring").front();
  const auto& spring = std::get<GroundSpring>(a.what);
  const auto u = on_all(body_, t, rotation(kAngle, kElsewhere));
  const double stretch =
      spring.direction.dot(kAngle.cross(Eigen::Vector3d(a.site.position - kElsewhere)));
  EXPECT_NEAR(quadratic(t.stiffness, u), 2e5 * stretch * stretch, 1e-7);
  EXPECT_NEAR(quadratic(t.damping, u), 3.0 * stretch * stretch, 1e-10);
}

TEST_P(AttachmentOn, TorsionSpringsFeelRotationsExactlyAndTranslationsNotAtAll) {
  const auto t = of("torsion");
  const auto spring = std::get<GroundTorsionSpring>(only(all_, "torsion").front().what);
  const double angle = spring.axis.dot(kAngle);
  const auto turned = on_all(body_, t, rotation(kAngle, kElsewhere));
  EXPECT_NEAR(quadratic(t.stiffness, turned), 40.0 * angle * angle,
              1e-12 + rounding(t.stiffness, turned));
  const auto moved = on_all(body_, t, translation({1.0, 2.0, 3.0}));
  EXPECT_NEAR(quadratic(t.stiffness, moved), 0.0, rounding(t.stiffness, moved));
}

TEST_P(AttachmentOn, LinksAndResonatorsLetRigidMotionsPass) {
  for (const std::string name : {"link", "shear link", "resonator"}) {
    const auto t = of(name);
    for (const auto& motion : {translation({1.0, 2.0, 3.0}), rotation(kAngle, kElsewhere)}) {
      const auto u = on_all(body_, t, motion);
      EXPECT_NEAR(quadratic(t.stiffness, u), 0.0, rounding(t.stiffness, u)) << name;
      EXPECT_NEAR(quadratic(t.damping, u), 0.0, rounding(t.damping, u)) << name;
    }
  }
}

TEST_P(AttachmentOn, MatricesArePositiveSemidefiniteSumsOfForms) {
  const auto t = terms(body_, all_);
  std::map<int, Eigen::Index> place;  // of the degrees of freedom that are touched
  for (const auto* list : {&t.stiffness, &t.mass, &t.damping}) {
    for (const auto& entry : *list) place.emplace(entry.row(), 0);
  }
  Eigen::Index count = 0;
  for (auto& entry : place) entry.second = count++;
  for (const auto* list : {&t.stiffness, &t.mass, &t.damping}) {
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(count, count);
    for (const auto& entry : *list) {
      lower(place.at(entry.row()), place.at(entry.col())) += entry.value();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(lower, Eigen::EigenvaluesOnly);
    EXPECT_GT(solver.eigenvalues().maxCoeff(), 0.0);
    EXPECT_GT(solver.eigenvalues().minCoeff(), -1e-13 * solver.eigenvalues().maxCoeff());
  }
  const auto u = on_all(body_, t, [](const auto& x) { return x.cwiseAbs2().eval(); });
  for (const auto& [forms, lower] :
       {std::pair{&t.springs, &t.stiffness}, {&t.masses, &t.mass}, {&t.dashpots, &t.damping}}) {
    double sum = 0.0;
    for (const auto& [row, value] : *forms) {
      double form = 0.0;
      for (const auto& [dof, factor] : row) form += factor * u(dof);
      sum += value * form * form;
    }
    EXPECT_NEAR(sum, quadratic(*lower, u), 1e-9 * sum);
  }
}

TEST_P(AttachmentOn, TurningEverythingChangesNothing) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  auto turned_body = body_;
  turned_body.points = body_.points * turn.transpose();
  const auto turned_site = [&](mesh::Site site) {
    site.position = turn * site.position;
    site.normal = turn * site.normal;
    return site;
  };
  const Field field = [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(std::sin(9.0 * x.y()), x.x() * x.z() + x.y(), std::cos(8.0 * x.x()));
  };
  const Field turned_field = [&](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(turn * field(turn.transpose() * x));
  };
  auto turned_all = all_;
  for (auto& a : turned_all) {
    a.site = turned_site(a.site);
    if (auto* m = std::get_if<PointMass>(&a.what)) {
      m->inertia = (turn * m->inertia * turn.transpose()).eval();
    }
    if (auto* s = std::get_if<GroundSpring>(&a.what)) s->direction = turn * s->direction;
    if (auto* s = std::get_if<GroundTorsionSpring>(&a.what)) s->axis = turn * s->axis;
    if (auto* s = std::get_if<Resonator>(&a.what)) s->direction = turn * s->direction;
    if (auto* s = std::get_if<LinkSpring>(&a.what)) {
      s->direction = turn * s->direction;
      s->other = turned_site(s->other);
    }
  }
  const auto t = terms(body_, all_);
  const auto turned = terms(turned_body, turned_all);
  const auto u = on_all(body_, t, field);
  const auto v = on_all(turned_body, turned, turned_field);
  EXPECT_NEAR(quadratic(turned.stiffness, v) / quadratic(t.stiffness, u), 1.0, 1e-9);
  EXPECT_NEAR(quadratic(turned.mass, v) / quadratic(t.mass, u), 1.0, 1e-9);
  EXPECT_NEAR(quadratic(turned.damping, v) / quadratic(t.damping, u), 1.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(EveryOrder, AttachmentOn,
                         ::testing::Combine(::testing::Values(1, 2, 3),
                                            ::testing::Values(0.0, 0.07)));

TEST(LinkSpring, FeelsTheStretchOfTheLineBetweenItsEnds) {
  const auto body = plate();
  const auto b = site_on(body, 0.12, 0.05);
  const auto t = terms(body, {{"link", site_on(body, -0.1, 0.05), 0.0,
                               LinkSpring{b, Eigen::Vector3d::Zero(), 1e6, 0.0}}});
  const Field strain = [](const Eigen::Vector3d& x) { return Eigen::Vector3d(1e-3 * x.x(), 0, 0); };
  EXPECT_NEAR(quadratic(t.stiffness, on_nodes(body, strain)), 1e6 * std::pow(1e-3 * 0.22, 2),
              1e-12);
  EXPECT_TRUE(t.damping.empty());
}

TEST(LinkSpring, OfTwoSitesOnOneFaceCountsSharedNodesOnce) {
  const auto body = plate();
  const auto a = site_on(body, 0.061, 0.02);
  const auto b = site_on(body, 0.063, 0.021);
  ASSERT_EQ(a.face, b.face);
  const auto t = terms(body, {{"link", a, 0.0, LinkSpring{b, {0.0, 0.0, 1.0}, 1.0, 0.0}}});
  // Bending without shear strain: half the curl is the slope. What is quadratic in the plane costs
  // nothing: the ends differ by the mean of their slopes times the distance.
  const Field bend = [](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(-2.0 * x.x() * x.z(), 0.0, x.x() * x.x());
  };
  const auto bent = on_nodes(body, bend);
  EXPECT_NEAR(quadratic(t.stiffness, bent), 0.0, rounding(t.stiffness, bent));
  // With shear strain the material turns by half the slope.
  const Field shear = [](const Eigen::Vector3d& x) { return Eigen::Vector3d(0, 0, x.x() * x.y()); };
  const auto sheared = on_nodes(body, shear);
  const double stretch = 0.5 * (0.063 * 0.021 - 0.061 * 0.02);
  EXPECT_NEAR(quadratic(t.stiffness, sheared), stretch * stretch,
              1e-20 + rounding(t.stiffness, sheared));
}

// ---- What attachments do to the modes.

Eigen::VectorXd eigenvalues(const System& system) {
  const Eigen::MatrixXd k = Eigen::MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd m = Eigen::MatrixXd(system.mass).selfadjointView<Eigen::Lower>();
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(k, m, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

struct CoarsePlate {
  mesh::TetMesh body = plate(2, 0.1);
  std::vector<Material> materials{isotropic(70e9, 0.33, 2700.0)};
  [[nodiscard]] System with(const std::vector<Attachment>& attachments) const {
    return assemble(body, materials, {}, attachments);
  }
};

TEST(Attached, AMassLowersEveryFrequency) {
  const CoarsePlate plate;
  const auto before = eigenvalues(plate.with({}));
  const Eigen::Matrix3d inertia = 1e-3 * Eigen::Matrix3d::Identity();
  const auto after = eigenvalues(
      plate.with({{"mass", site_on(plate.body, 0.1, 0.06), 0.0, PointMass{0.3, inertia}}}));
  const double noise = 1e-9 * before(20);
  for (Eigen::Index i = 6; i < before.size(); ++i) EXPECT_LE(after(i), before(i) + noise) << i;
  EXPECT_LT(after(6), 0.95 * before(6));
}

TEST(Attached, AGroundSpringRaisesEveryFrequencyToAtMostTheNext) {
  const CoarsePlate plate;
  const auto before = eigenvalues(plate.with({}));
  const auto after = eigenvalues(plate.with(
      {{"spring", site_on(plate.body, 0.1, 0.06), 0.02, GroundSpring{{0, 0, 1}, 3e7, 0.0}}}));
  const double noise = 1e-9 * before(20);
  for (Eigen::Index i = 0; i + 1 < before.size(); ++i) {
    EXPECT_GE(after(i), before(i) - noise) << i;
    EXPECT_LE(after(i), before(i + 1) + 1e-9 * before(i + 1) + noise) << i;
  }
  EXPECT_GT(after(6), 1.01 * before(6));
}

TEST(Attached, AResonatorTunedToAModeSplitsIt) {
  const CoarsePlate plate;
  const auto free = plate.with({});
  const Eigen::MatrixXd k = Eigen::MatrixXd(free.stiffness).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd m = Eigen::MatrixXd(free.mass).selfadjointView<Eigen::Lower>();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(k, m);
  const auto site = site_on(plate.body, 0.149, 0.099);
  const double lambda = solver.eigenvalues()(6);
  const double shape =
      mesh::row_at(site, {0, 0, 1}, plate.body.node_count()).dot(solver.eigenvectors().col(6));
  const double mass = 1e-4 / (shape * shape);  // modal mass ratio μ = m φ²
  const auto after = eigenvalues(
      plate.with({{"tuned", site, 0.0, Resonator{{0, 0, 1}, mass, mass * lambda, 0.0}}}));
  ASSERT_EQ(after.size(), solver.eigenvalues().size() + 1);
  // Two modes at ω (1 ± √μ / 2) in the place of one (Den Hartog 1956, section 3.3).
  EXPECT_NEAR(std::sqrt(after(6) / lambda), 1.0 - 0.005, 1e-4);
  EXPECT_NEAR(std::sqrt(after(7) / lambda), 1.0 + 0.005, 1e-4);
  EXPECT_NEAR(after(8) / solver.eigenvalues()(7), 1.0, 1e-3);
}

TEST(Attached, LinksAndResonatorsLeaveSixRigidMotions) {
  const CoarsePlate plate;
  const auto all = one_of_each(plate.body, 0.0);
  const auto system = plate.with({all[0], all[3], all[4], all[5]});
  EXPECT_EQ(system.rigid.cols(), 6);
  const auto values = eigenvalues(system);
  EXPECT_LT(values.head(6).cwiseAbs().maxCoeff(), 1e-9 * values(6));
}

TEST(Attached, MassPropertiesCountThem) {
  const CoarsePlate plate;
  const auto all = one_of_each(plate.body, 0.05);
  const std::vector<Attachment> masses{all[0], all[5]};
  const auto properties = mass_properties(plate.body, plate.materials, masses);
  const auto system = plate.with(masses);
  const auto t = terms(plate.body, masses);
  const auto weight = [&](const Field& motion) {
    const auto u = on_all(plate.body, t, motion);
    return u.dot(Eigen::VectorXd(system.mass.selfadjointView<Eigen::Lower>() * u));
  };
  EXPECT_NEAR(weight(translation({0, 0, 1})), properties.mass_kg, 1e-12 * properties.mass_kg);
  const double expected = kAngle.dot(properties.inertia_kg_m2 * kAngle);
  EXPECT_NEAR(weight(rotation(kAngle, properties.centre_m)), expected, 1e-9 * expected);
}

// ---- What is refused.

std::string refusal(const mesh::TetMesh& body, const Attachment& attachment) {
  try {
    (void)terms(body, {attachment});
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Attachments, RefuseWhatCannotBeMeantByName) {
  const auto body = plate(1);
  const auto site = site_on(body, 0.01, 0.02);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d indefinite = Eigen::Matrix3d::Identity();
  indefinite(0, 1) = indefinite(1, 0) = 2.0;
  Eigen::Matrix3d skew = Eigen::Matrix3d::Identity();
  skew(0, 1) = 0.5;
  auto foreign = site;
  foreign.nodes(0) = 1000000;
  const std::vector<Attachment> wrong{
      {"odd one", site, 0.0, PointMass{.mass = -1.0}},
      {"odd one", site, 0.0, PointMass{.mass = nan}},
      {"odd one", site, 0.0, PointMass{1.0, indefinite}},
      {"odd one", site, 0.0, PointMass{1.0, skew}},
      {"odd one", site, 0.0, GroundSpring{2.0 * z, 1.0, 0.0}},
      {"odd one", site, 0.0, GroundSpring{Eigen::Vector3d::Zero(), 1.0, 0.0}},
      {"odd one", site, 0.0, GroundSpring{z, -1.0, 0.0}},
      {"odd one", site, 0.0, GroundSpring{z, 1.0, -1.0}},
      {"odd one", site, 0.0, GroundSpring{z, nan, 0.0}},
      {"odd one", site, 0.0, GroundTorsionSpring{nan * z, 1.0, 0.0}},
      {"odd one", site, 0.0, GroundTorsionSpring{z, std::numeric_limits<double>::infinity(), 0.0}},
      {"odd one", site, 0.0, LinkSpring{site, Eigen::Vector3d::Zero(), 1.0, 0.0}},
      {"odd one", site, 0.0, LinkSpring{site, z, -1.0, 0.0}},
      {"odd one", site, 0.0, LinkSpring{foreign, z, 1.0, 0.0}},
      {"odd one", site, 0.0, Resonator{z, 0.0, 1.0, 0.0}},
      {"odd one", site, 0.0, Resonator{z, 1.0, 0.0, 0.0}},
      {"odd one", site, -0.1, GroundSpring{z, 1.0, 0.0}},
      {"odd one", site, nan, GroundSpring{z, 1.0, 0.0}},
      {"odd one", site, 1e-12, GroundSpring{z, 1.0, 0.0}},
      {"odd one", foreign, 0.0, GroundSpring{z, 1.0, 0.0}}};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    const auto message = refusal(body, wrong[i]);
    EXPECT_NE(message.find("attachment \"odd one\""), std::string::npos) << i << ": " << message;
  }
}

TEST(Attachments, SayWhatWasFoundAndExpected) {
  const auto body = plate(1);
  EXPECT_EQ(refusal(body, {"flexure_1", site_on(body, 0.01, 0.02), 0.0,
                           GroundSpring{{0, 0, 1}, -5.0, 0.0}}),
            "attachment \"flexure_1\": the stiffness is -5 N/m; expected zero or more");
}

}  // namespace
}  // namespace chladni::fem
