"""Keys that other programs rely on, and small studies that leave every JSON file."""
HEAD = {"chladni", "study", "seed", "seconds"}
# Keys that other programs rely on.
CONTRACT = {
    "modes.json": HEAD | {"rigid_body_modes", "frequency_hz", "residual", "degrees_of_freedom", "mass_kg",
                          "centre_of_mass_m", "inertia_kg_m2", "complete", "sensors", "actuators"},
    "placement.json": HEAD | {"criterion", "best", "layouts", "optimum"},
    "priors.json": HEAD | {"modes", "shared"},
    "identified.json": HEAD | {"modes", "output_matrix", "input_matrix", "gain_match", "fit", "noise_floor"},
    "interpolation.json": HEAD | {"methods"},
    "diagnosis.json": HEAD | {"verdict"},
}
INNER_CONTRACT = {
    ("placement.json", "$defs", "pair"): {"x_m", "y_m", "z_m", "score", "limiting_mode"},
    ("placement.json", "$defs", "optimum"): {"sites", "score", "bound", "gap"},
    ("placement.json", "properties", "layouts", "items"): {"name", "sensors", "actuators", "scores"},
    ("priors.json", "$defs", "mode"): {"kernel", "length_scale_m", "sigma", "noise",
                                       "log_marginal_likelihood", "samples"},
    ("identified.json", "properties", "modes", "items"): {"frequency_hz", "damping_ratio", "frequency_std_hz",
                                                          "damping_std", "rigid"},
    ("identified.json", "properties", "gain_match"): {"alpha", "alpha_std"},
    ("interpolation.json", "properties", "methods", "items", "properties", "held_out", "items"):
        {"channel", "frf_error", "shape_error", "coverage"},
    ("diagnosis.json", "$defs", "one"): {"discrepancy", "causes", "alternatives", "gain"},
    ("diagnosis.json", "$defs", "cause"): {"effect", "parameters", "log_evidence_gain", "probability"},
    ("diagnosis.json", "$defs", "number"): {"value", "std"},
    ("diagnosis.json", "$defs", "one", "properties", "gain"): {"fit", "held_out", "noise_floor"},
    ("diagnosis.json", "$defs", "before_after"): {"before", "after"},
}

PLATE = """
geometry = { plate = { length = "300 mm", width = "200 mm", thickness = "%s" } }
material = { youngs_modulus = "70 GPa", poissons_ratio = 0.33, density = "2700 kg/m^3" }
mesh = { edge_length = "50 mm", order = 2 }
modes = { count = 10, damping_ratio = 0.01 }
"""
ON_IT = '[[attachment]]\nkind = "mass"\nname = "clamp"\nat = ["60 mm", "30 mm"]\nmass = "%s"\n'
PLACES = {"s1": (-140, 90), "s2": (140, 90), "s3": (130, -90), "s4": (-20, -80), "s5": (-140, -60),
          "a1": (-140, 90), "a2": (70, -40), "a3": (140, 90)}
MEASURED = """
[measurement]
frf = "measured.csv"
hold_out = ["s4"]
[experiment]
noise_ratio = 0.002
band = ["20 Hz", "1500 Hz"]
sample_rate = "8192 Hz"
samples = 4096
periods = 3
realisations = 2
controlled = ["a1", "a2", "a3"]
bandwidth = "20 Hz"
[state_space]
sample_rate = "10 kHz"
[placement]
modes = 3
[priors]
modes = 3
samples = [25, 50]
[interpolation]
point = [{ name = "middle", at = ["0 mm", "0 mm"] }]
polynomial_degree = 4
[observer]
noise = "20 nm"
[[observer.point]]
name = "middle"
at = ["0 mm", "0 mm"]
[[observer.disturbance]]
name = "amplifier"
kind = "actuators"
rms = "0.2 N"
[diagnosis]
effects = ["point_mass", "sensor_gain"]
lines = 60
"""
RECORDED = """
[measurement]
time = "recorded/simulate/time_data.csv"
[identification]
damping = "general"
stabilisation = 12
[experiment]
leaves = "time"
lines = "odd_with_detection"
noise_ratio = 0.002
band = ["20 Hz", "1500 Hz"]
sample_rate = "8192 Hz"
samples = 8192
periods = 3
warm_up = 9
realisations = 2
controlled = ["a1", "a2", "a3"]
bandwidth = "20 Hz"
"""
EXPECT = """
[expect]
mass = { value = "1296 g", within = "1 g" }
frequency_1 = { value = "500 Hz", within = "50 %" }
"""
PLAN = """
title = "thickness"
base = "study.toml"
[[axis]]
key = "geometry.plate.thickness"
values = ["8 mm", "9 mm"]
[[result]]
name = "first"
file = "modes.json"
at = "frequency_hz.6"
unit = "Hz"
"""


def channels():
    tables = []
    for name, (x, y) in PLACES.items():
        kind = "sensor" if name[0] == "s" else "actuator"
        tables.append(f'[[{kind}]]\nname = "{name}"\nat = ["{x} mm", "{y} mm"]\ndirection = "z"\n')
    return "".join(tables)
