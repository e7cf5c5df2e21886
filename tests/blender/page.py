"""docs/reports/cycles.md: the tables of what was found, with the reasons of each difference."""

import numpy
import picture

NAMES = {
    "metal": "metal", "plastic": "rough plastic", "rough": "rough translucent", "smooth": "smooth translucent",
}
LAYERS = {"diffuse": "diffuse", "glossy": "mirrored", "transmission": "scattered"}
RINGS = ("middle, cosine above 0.8", "ring, 0.5 to 0.8", "limb, below 0.5")


def three(values, form="{:.3f}"):
    return " ".join(form.format(value) for value in values)


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def hidden(value, error, form):
    """A square, or the bound below which the noise hides it, twice its standard error."""
    return form(value) if value > 2 * error else f"<{form(max(value, 0) + 2 * error)}"


def largest(error):
    return f"{100 * max(error):.2f} %"


def pictures(found):
    heads = ["sphere", "light of ours / Cycles", "standard error", "relative RMSE, %", "relMSE",
             "noise of a pixel, ours, Cycles", "processor seconds, ours, Cycles"]
    rows = []
    named = [(NAMES[kind], case, None) for kind, case in found.items()]
    named += [(f"{NAMES[kind]}, `--reference`", found[kind], found[kind].exact) for kind in ("rough", "smooth")]
    for name, case, pair in named:
        pair = pair or case.ours
        ratio, error = case.ratio(pair=pair)
        mse, relmse = (list(zip(*part)) for part in case.errors(pair))
        rmse = " ".join(hidden(*one, lambda x: f"{100 * x**0.5:.1f}") for one in mse)
        noise = [f"{100 * one.noise(case.mask):.1f} %" for one in (pair, case.theirs)]
        seconds = [f"{one.seconds:.0f}" for one in (pair, case.theirs)]
        rows.append([name, three(ratio), largest(error), rmse, hidden(*max(relmse), "{:.0e}".format),
                     ", ".join(noise), ", ".join(seconds)])
    return table(heads, rows)


def layers(found):
    rows = []
    for kind, case in found.items():
        whole = case.theirs.light(case.mask)
        for layer, name in LAYERS.items():
            light = case.theirs.light(case.mask, layer)
            if light.max() > 0:
                ratio, error = case.ratio(layer)
                rows.append([NAMES[kind], name, three(100 * light / whole, "{:.1f}"), three(ratio), largest(error)])
    return table(["sphere", "layer", "share of the light, %", "ours / Cycles", "standard error"], rows)


def models(found):
    rows = []
    for kind, layers in (("metal", ["glossy"]), ("plastic", ["glossy", "diffuse"]), ("rough", ["glossy"])):
        case = found[kind]
        for layer in layers:
            own = "ours" if kind != "rough" else "theirs"
            row = [NAMES[kind], LAYERS[layer], three(case.over_model(own, layer), "{:.4f}")]
            if own == "theirs":
                row[-1] = three(case.ours.light(case.points, layer) / case.model(own, layer), "{:.4f}")
            row.append(three(case.over_model("theirs", layer), "{:.4f}"))
            row.append(three(case.model(own, layer) / case.model("theirs", layer)) if own == "ours" else "the same")
            exact = case.models.get("exact")
            row.append(three(case.model("exact", layer) / case.model("theirs", layer)) if exact else "")
            rows.append(row)
    heads = ["sphere", "layer", "ours / model of ours", "Cycles / model of Cycles", "model of ours / of Cycles",
             "the same with Fresnel's equations in ours"]
    return table(heads, rows)


def rings(found):
    rough, smooth = found["rough"], found["smooth"]
    rows = []
    for name, a, b in zip(RINGS, rough.rings(), smooth.rings()):
        cells = [(case, pair, mask) for case, mask in ((rough, a), (smooth, b)) for pair in (case.exact, case.ours)]
        row = [name]
        for case, pair, mask in cells:
            ratio, error = case.ratio("transmission", pair, mask)
            row.append(f"{three(ratio)} ({largest(error)})")
        rows.append(row)
    heads = ["where", "rough, `--reference` / Cycles", "rough, ours / Cycles", "smooth, `--reference` / Cycles",
             "smooth, ours / Cycles"]
    return table(heads, rows)


def by_brightness(case):
    """How much brighter red of the metal is by our model, in percent: the darkest quarter and the brightest tenth."""
    ours, theirs = (case.models[name]["glossy"][:, 0] for name in ("ours", "theirs"))
    dark, bright = theirs <= numpy.quantile(theirs, 0.25), theirs >= numpy.quantile(theirs, 0.9)
    return [f"{100 * (ours[part].sum() / theirs[part].sum() - 1):+.1f}" for part in (dark, bright)]


def noises(case):
    """The noise of the metal by one path and by many, in percent."""
    many = [pair.noise(case.mask) for pair in (case.ours, case.theirs)]
    names = ("one_mine", "one_other", "many_mine", "many_other")
    return {name: f"{100 * noise:.1f}" for name, noise in zip(names, [*case.noise_of_one, *many])}


def clouds(found):
    """The largest difference of the mean light of the translucent spheres by two clouds, in percent."""
    cases = found["rough"], found["smooth"]
    pairs = [[one["beauty"][case.mask].mean(0) for one in case.ours.pictures] for case in cases]
    return f"{100 * max(float(abs(a / b - 1).max()) for a, b in pairs):.1f}"


def roughened(found):
    """How much roughness changes scattered light, in percent: ours, our walks, Cycles, and the standard error of that."""
    lines = []
    for name in ("ours", "exact", "theirs"):
        a, b = (getattr(found[k], name).light(found[k].mask, "transmission") for k in ("rough", "smooth"))
        lines.append(three(100 * (a / b - 1), "{:+.1f}"))
    errors = [found[k].theirs.error(found[k].mask, "transmission") for k in ("rough", "smooth")]
    return [*lines, f"{100 * float((errors[0] ** 2 + errors[1] ** 2).max()) ** 0.5:.1f}"]


def write(found, version, paths, folder):
    """Writes the page and its picture; `paths` are those of the metal for each pixel, of ours and of Cycles."""
    picture.write([case for kind, case in found.items() if kind != "smooth"], folder / "cycles.png")
    mine, exact, other, spread = roughened(found)
    dark, bright = by_brightness(found["metal"])
    text = TEXT.format(
        version=version, pictures=pictures(found), layers=layers(found), models=models(found), rings=rings(found),
        background=f"{100 * max(case.background() for case in found.values()):.4f}", mine=mine, other=other,
        exact=exact, spread=spread, clouds=clouds(found),
        dark=dark, bright=bright, paths=paths[0], samples=paths[1], **noises(found["metal"]),
    )
    (folder / "cycles.md").write_text(text)


TEXT = """# Rough surfaces beside Cycles

Made by `make cycles`; do not edit. Cycles is the path tracer of Blender, here {version} on processors. Spheres of a
metal, of a rough plastic and of a rough translucent body stand under one environment,
`data/environments/studio.hdr`, each alone, and are rendered by both from the same scene, which Blender exports as
glTF. A smooth translucent sphere is the control.

![Rows: metal, plastic, translucent. Columns: ours, Cycles, their signed difference](cycles.png)

*Rows: metal, rough plastic, rough translucent. Columns: ours, Cycles, and the signed difference in blocks of 4 x 4
pixels, relative to √(Cycles² + (0.1 m)²) with the mean light m of the sphere: red where ours is brighter, blue where
it is darker, full color at 20 %.*

{pictures}

All figures are of the pixels of the sphere but the two at its border, in the order red, green, blue. Each renderer
has two pictures with independent noise, so that RMSE and relMSE, the mean of (t - r)²/(r² + 0.01), are those of
blocks of 4 x 4 pixels *without* noise: `<` is what the noise hides. The standard error is that of the ratio by
the noise of the pixels; the error of our clouds, and of the calibrations that belong to them, comes on top: the
translucent spheres of two clouds differ by {clouds} % at most. Seconds are those of all threads for one picture,
cloud and calibration included.

The environment lies alike: beside the spheres the mean light differs by {background} %.

## The scenes

* Metal: color 0.944 0.776 0.373, roughness 0.3. Plastic: color 0.1 0.3 0.6, roughness 0.4, index 1.5.
* Translucent: a sphere of 40 mm, index 1.4, roughness 0.3 or smooth, with the absorption 2, 10 and 40 /m and the
  scattering 600 /m, isotropic: 24 to 26 mean free paths across. In Blender it is a *Principled BSDF* of
  *Transmission* 1 around the node *Volume Coefficients*; the exporter leaves the volume out, and the property
  `medium` states the same numbers.
* Cycles: *Multiscatter GGX*, no clamping, no *Filter Glossy*, caustics, 1024 bounces, no denoiser, no adaptive
  sampling, a filter of one pixel (*Box*), the environment without interpolation, which is how ours takes it; written
  as linear OpenEXR.

## Where the light goes

{layers}

*Mirrored* is ours `specular` and of Cycles *Glossy*, *scattered* ours `subsurface` and `transmission` and of Cycles
*Transmission*: light by the first event of the path.

## Which difference is a model's

A third program, `tests/blender/quadrature.py`, sums the reflection of the opaque spheres over the environment's
pixels, by the formulas of both renderers, at a quarter of the pixels: standard errors are twice those above. Each
renderer agrees with its own, so that no difference is left to chance or to a fault:

{models}

* **Metal.** GGX, Smith's height-correlated shadows and Schlick's reflectance are the same. Light that meets several
  microfacets is a wide lobe of its own here ([method](../method.md), 18.2; Kulla and Conty 2017), and in Cycles a
  factor on single reflections, 1 + F_ms (1 - E)/E (Turquin 2019). Both reflect all light of a white furnace. Here
  the wide lobe gathers light of the windows where the sphere mirrors dark walls: by the models, red of the darkest
  quarter of the sphere differs by {dark} % in ours, and that of the brightest tenth by {bright} %.
* **Plastic, mirrored.** Ours has Schlick's reflectance with f₀ = 0.04, as appendix B of glTF asks for, Cycles the
  equations of Fresnel. At an index of 1.5 Schlick's is lower up to 74°, by a fifth at 60°. With Fresnel's equations
  in our model the rest is that of several reflections (last column).
* **Plastic, diffuse.** The base gets what the layer leaves. Cycles weighs it by 1 - R(μ_o), of the viewer alone;
  ours by (1 - R(μ_o))(1 - R(μ_i))/(1 - R̄), which is reciprocal (18.3). The same light in a furnace, but ours takes
  more of light from the front. The other half of the difference is again Schlick's, whose layer leaves more to the
  base.
* **Rough translucent, mirrored.** Both have Fresnel's equations and agree. The third program gives back what a metal
  would of several reflections, and not what a boundary that refracts does (18.4): half a percent too little.

## Below a rough boundary

Scattered light by the cosine between the view and the normal, ratios with standard errors:

{rings}

* **`--reference` / Cycles.** Two programs that follow random walks without approximation: index, coefficients and
  light mean the same in both, and a rough boundary, through which a walk passes by its microfacets here as there. The
  columns of a sphere share the noise of Cycles: both have the same pictures of it.
* **Ours / Cycles** is the error of the calibrated model ([accuracy](accuracy.md)), with the entry and exit of light
  through a rough boundary (method.md, 18.6 and 18.7).
* Roughness changes the scattered light of the whole sphere by {mine} % in ours, by {exact} % in our walks and by
  {other} % in Cycles, with a standard error of {spread} %. A walk meets the boundary several times, and the two
  programs differ in what meets several microfacets there: a direction of its own here, and in Cycles a factor on those
  that meet one (see *Metal*). With a rule like that of Cycles, by which such light draws another microfacet, our walks
  are 0.45, 0.59 and 0.79 % brighter (standard error 0.14 %), alike in all three parts of the sphere. Measured once, with
  320 paths of Cycles and 1024 of ours: the whole sphere is 0.992 0.990 0.987 of that of Cycles (standard error 0.2 %)
  and with that rule 0.996 0.996 0.994, as the smooth one is; the ring 0.996 0.995 0.989 and 1.001 1.001 0.997 (0.3 %).

## Noise and time

At one path for each pixel the metal has a noise of {one_mine} % in ours and {one_other} % in Cycles: lights and
mirrored directions are sampled equally well. Both spread directions evenly over the paths of a pixel, ours at the
first surface alone: with {paths} paths of ours and {samples} of Cycles it is {many_mine} % and {many_other} %. With the translucent spheres it is the other way round: ours
sums over a cloud what Cycles follows from collision to collision, and has a small part of its noise in a like time.
"""
