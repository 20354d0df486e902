// Settings of the odometry, for Python.
#include <span>
#include <string>

#include <pybind11/pybind11.h>

#include "python/bindings/bindings.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/tuned_constants.hpp"

namespace py = pybind11;

namespace cartvo::python {
namespace {

/// Adds an attribute that can be set.
template <typename Class, typename Member>
void add(Class& python_class, const char* name, Member member, const char* text) {
  python_class.def_readwrite(name, member, text);
}

void bindValidity(py::module_& module) {
  using Validity = vo::ValiditySettings;
  py::class_<Validity> validity(module, "ValiditySettings", "Conditions of a valid motion.");
  add(validity, "minimum_features", &Validity::minimum_features, "detected in the left image");
  add(validity, "minimum_matches", &Validity::minimum_matches, "with a depth, in both pairs");
  add(validity, "minimum_inliers", &Validity::minimum_inliers, "consistent with the motion");
  add(validity, "minimum_inlier_ratio", &Validity::minimum_inlier_ratio, "inliers / matches");
  add(validity, "maximum_time_step", &Validity::maximum_time_step, "s between pairs");
  add(validity, "maximum_offset", &Validity::maximum_offset, "s between the exposures of a pair");
  add(validity, "maximum_offset_uncertainty", &Validity::maximum_offset_uncertainty,
      "s, standard deviation of the time offset");
  add(validity, "maximum_speed", &Validity::maximum_speed, "m/s");
  add(validity, "maximum_rate", &Validity::maximum_rate, "rad/s");
}

void bindStereo(py::module_& module) {
  using Stereo = vo::StereoSettings;
  py::class_<Stereo> stereo(module, "StereoSettings", "Stereo matching from left to right.");
  add(stereo, "minimum_disparity", &Stereo::minimum_disparity, "px; farther points have no usable depth");
  add(stereo, "maximum_disparity", &Stereo::maximum_disparity, "px; nearer points are not found");
  add(stereo, "rows", &Stereo::rows, "px, rows searched above and below");
  add(stereo, "minimum_correlation", &Stereo::minimum_correlation,
      "normalised cross-correlation of the patches");
  add(stereo, "uniqueness", &Stereo::uniqueness,
      "maximum ratio of 1 - correlation, best to second-best match");
}

void bindTracking(py::module_& module) {
  using Tracking = vo::TrackingSettings;
  py::class_<Tracking> tracking(module, "TrackingSettings", "Tracking from pair to pair.");
  add(tracking, "levels", &Tracking::levels, "pyramid levels, the full image included");
  add(tracking, "iterations", &Tracking::iterations, "maximum number of iterations of the last step");
  add(tracking, "convergence", &Tracking::convergence, "px, length of a step that ends the iteration");
  add(tracking, "minimum_correlation", &Tracking::minimum_correlation, "normalised cross-correlation");
  add(tracking, "maximum_backward_error", &Tracking::maximum_backward_error, "px, forward-backward error");
  add(tracking, "minimum_distance", &Tracking::minimum_distance, "px between features");
  add(tracking, "search_again", &Tracking::search_again, "pairs over which a lost feature is searched for");
}

void bindStandstill(py::module_& module) {
  using Standstill = vo::StandstillSettings;
  py::class_<Standstill> standstill(module, "StandstillSettings", "Detection of a standstill.");
  add(standstill, "translation", &Standstill::translation, "m");
  add(standstill, "rotation", &Standstill::rotation, "rad");
  add(standstill, "least_time", &Standstill::least_time, "s, minimum duration");
}

py::list listOf(std::span<const vo::TunedConstant> constants) {
  py::list list;
  for (const vo::TunedConstant& constant : constants)
    list.append(py::cast(&constant, py::return_value_policy::reference));  // lives as long as the program
  return list;
}

void setConstant(vo::OdometrySettings& settings, const std::string& name, double value) {
  for (const vo::TunedConstant& constant : vo::tunedConstants()) {
    if (constant.name == name) return constant.set(value, settings);
  }
  throw py::value_error("there is no tuned constant '" + name + "'; tuned_constants() lists them");
}

void bindTunedConstants(py::module_& module) {
  using vo::TunedConstant;
  py::class_<TunedConstant>(module, "TunedConstant", "A tuned constant of the default estimator.")
      .def_readonly("name", &TunedConstant::name, "for Settings.set_constant()")
      .def_readonly("unit", &TunedConstant::unit, "empty: a ratio, share or count")
      .def_readonly("low", &TunedConstant::low, "end of the permitted range")
      .def_readonly("high", &TunedConstant::high, "end of the permitted range")
      .def_readonly("source", &TunedConstant::source, "derivation, paper or measurement of the default")
      .def_property_readonly(
          "default", [](const TunedConstant& self) { return self.value({}); }, "value in Settings()")
      .def_property_readonly("is_integer", &TunedConstant::isInteger, "whether it takes whole numbers only");
  module.def(
      "tuned_constants", [] { return listOf(vo::tunedConstants()); },
      "The tuned constants of the default estimator, for experiments; see Settings.set_constant().");
  module.def(
      "product_limits", [] { return listOf(vo::productLimits()); },
      "The limits of the product, which are requirements and not tuned.");
}

/// Settings with the defaults, except for the named ones.
vo::OdometrySettings settingsOf(const py::kwargs& named) {
  vo::OdometrySettings settings;
  const py::object object = py::cast(&settings, py::return_value_policy::reference);
  for (const auto& [name, value] : named) {
    if (!py::hasattr(object, name))
      throw py::type_error("Settings: no setting '" + std::string(py::str(name)) + "'");
    py::setattr(object, name, value);
  }
  return settings;
}

}  // namespace

void bindSettings(py::module_& module) {
  py::enum_<vo::Estimator>(module, "Estimator", "Method that estimates the motion.")
      .value("REPROJECTION", vo::Estimator::reprojection)
      .value("THESIS", vo::Estimator::thesis);
  py::enum_<vo::RigRefinement>(module, "RigRefinement", "Self-calibration of the rig.")
      .value("OFF", vo::RigRefinement::off)
      .value("CORRECT", vo::RigRefinement::correct);
  bindValidity(module);
  bindStereo(module);
  bindTracking(module);
  bindStandstill(module);
  bindTunedConstants(module);

  using Settings = vo::OdometrySettings;
  py::class_<Settings> settings(
      module, "Settings",
      "Settings of the odometry. The defaults are those of cartvod; each can be named: "
      "Settings(features=500). Ranges are checked when the settings are used.");
  settings.def(py::init(&settingsOf));
  settings.def("set_constant", &setConstant, py::arg("name"), py::arg("value"),
               "Sets a tuned constant, rounded if it is an integer. Raises ValueError for another name.");
  add(settings, "estimator", &Settings::estimator, "method that estimates the motion");
  add(settings, "features", &Settings::features, "target number of features in each left image, 50 to 20000");
  add(settings, "seed", &Settings::seed, "of the random subsets");
  add(settings, "rig_refinement", &Settings::rig_refinement, "self-calibration of the rig");
  add(settings, "tracking", &Settings::tracking, "tracking from pair to pair");
  add(settings, "stereo", &Settings::stereo, "stereo matching");
  add(settings, "standstill", &Settings::standstill, "detection of a standstill");
  add(settings, "validity", &Settings::validity, "conditions of a valid motion");
}

}  // namespace cartvo::python
