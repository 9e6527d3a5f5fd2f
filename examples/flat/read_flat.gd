# Runs a flat level of the Spring Sandbox in Godot 4 and draws it, in a Node2D: set `path`, and `scale` in pixels a metre.
#
# Made with: sandbox export LEVEL --to flat -o level.json
# What differs: discs touch terrain alone; areas, bends, motors, hydraulics and breaking are not there.
extends Node2D

# Sweeps over rods in a step: more make them stiffer.
const SWEEPS = 30

@export_file("*.json") var path = "res://level.json"

var level = {}
var h = 0.0
var tick = 0
var x = []  # places [m], y up; Vector2 has six digits, enough to look at
var v = []
var w = []
var edges = []
var lengths = []


func _ready():
	level = JSON.parse_string(FileAccess.get_file_as_string(path))
	Engine.physics_ticks_per_second = int(level.rate)
	h = 1.0 / (level.rate * level.steps)
	scale = Vector2(100.0, -100.0)
	for part in level.get("particles", []):
		x.append(place(part.position))
		v.append(place(part.get("velocity", [0.0, 0.0])))
		w.append(0.0 if part.get("pinned", false) else 1.0 / part.mass)
	for spring in level.get("springs", []):
		lengths.append(spring.rest_length)
	for piece in level.get("terrain", []):
		var corners = piece.corners.map(place)
		if piece.kind != "line":
			corners.append(corners[0])
		for i in range(1, corners.size()):
			edges.append([corners[i - 1], corners[i], piece.friction])


func place(pair):
	return Vector2(pair[0], pair[1])


func _physics_process(_delta):
	for muscle in level.get("muscles", []):
		var u = fposmod(float(tick) / muscle.period + muscle.phase, 1.0)
		var wave = 16.0 * u * (0.5 - u) if u < 0.5 else -16.0 * (u - 0.5) * (1.0 - u)
		lengths[muscle.spring] = level.springs[muscle.spring].rest_length * (1.0 + muscle.amplitude * wave)
	for step in int(level.steps):
		advance()
	tick += 1
	queue_redraw()


func advance():
	var wind = place(level.get("wind", [0.0, 0.0]))
	var air = level.get("drag", 0.0) * h / (1.0 + level.get("drag", 0.0) * h)
	for p in x.size():
		if w[p] > 0.0:
			v[p] += place(level.gravity) * level.particles[p].get("gravity_scale", 1.0) * h
			v[p] += air * (wind - v[p])
	# Forces k x first, of the places before the step; then dampers one by one, which can never overshoot; rods last.
	for kind in ["force", "damper"]:
		for s in lengths.size():
			if not level.springs[s].get("rod", false):
				pull(s, kind)
	for sweep in SWEEPS:
		for s in lengths.size():
			if level.springs[s].get("rod", false):
				pull(s, "rod")
	for p in x.size():
		if w[p] > 0.0:
			touch(p)
		x[p] += v[p] * h


func pull(s, kind):
	var spring = level.springs[s]
	var a = int(spring.a)
	var b = int(spring.b)
	var weight = w[a] + w[b]
	var d = x[b] - x[a]
	if weight == 0.0 or d == Vector2.ZERO:
		return
	var n = d.normalized()
	var u = n.dot(v[b] - v[a])
	var error = d.length() - lengths[s]
	var j = -(error / h + u) / weight
	if kind == "force":
		j = -spring.k * error * h
	elif kind == "damper":
		j = -u / weight * (1.0 - exp(-spring.c * h * weight))
	v[a] -= j * w[a] * n
	v[b] += j * w[b] * n


# A disc that would be in an edge after the step stops there; friction takes what is along it, no more.
func touch(p):
	var surface = level.surfaces[level.particles[p].surface]
	if not surface.touches.has(0.0):
		return
	for edge in edges:
		var gap = x[p] - Geometry2D.get_closest_point_to_segment(x[p], edge[0], edge[1])
		var n = gap.normalized()
		var push = maxf(0.0, -n.dot(v[p]) - maxf(gap.length() - level.particles[p].radius, -0.01) / h)
		var most = push * sqrt(surface.friction * edge[2])
		v[p] += push * n + clampf(-n.orthogonal().dot(v[p]), -most, most) * n.orthogonal()


func _draw():
	for edge in edges:
		draw_line(edge[0], edge[1], Color.SADDLE_BROWN, 0.03)
	for spring in level.get("springs", []):
		draw_line(x[spring.a], x[spring.b], Color.SLATE_GRAY, 0.01)
	for p in x.size():
		draw_circle(x[p], maxf(level.particles[p].radius, 0.02), Color.TEAL if w[p] == 0.0 else Color.CORAL)
