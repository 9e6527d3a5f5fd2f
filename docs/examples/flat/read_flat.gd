# Runs a flat level of the Spring Sandbox in Godot 4 and draws it: the script of a Node2D; set `path`.
#
# ```sh
# sandbox export walker --to flat -o level.json
# ```
#
# Not tried in Godot by its makers. What differs: discs touch terrain alone; areas, bends, motors, hydraulics and
# breaking are not there.
extends Node2D

# Sweeps over the springs in a step: more make bodies stiffer.
const SWEEPS = 30
# How fast discs leave what they are in [1/s].
const OUTWARD = 5.0

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


func surface_of(p):
	return level.surfaces[int(level.particles[p].surface)]


func _physics_process(_delta):
	for muscle in level.get("muscles", []):
		var u = fposmod(float(tick) / muscle.period + muscle.phase, 1.0)
		var wave = 16.0 * u * (0.5 - u) if u < 0.5 else -16.0 * (u - 0.5) * (1.0 - u)
		var s = int(muscle.spring)
		lengths[s] = level.springs[s].rest_length * (1.0 + muscle.amplitude * wave)
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
	# J = -K (u' + b), K = h (c + h k) and b = k x / (c + h k), as many springs agree on it after some sweeps.
	var rows = []
	for s in lengths.size():
		add_row(rows, level.springs[s], lengths[s])
	var touches = []
	for p in x.size():
		if w[p] > 0.0 and surface_of(p).touches.any(func(group): return int(group) == 0):
			add_touches(touches, p)
	for sweep in SWEEPS:
		for row in rows:
			pull(row)
		for touch in touches:
			push(touch)
	for p in x.size():
		x[p] += v[p] * h


# Direction n, softness 1 / K and bias b of a spring in this step; a rod's softness is 0.
func add_row(rows, spring, rest_length):
	var a = int(spring.a)
	var b = int(spring.b)
	var d = x[b] - x[a]
	var error = d.length() - rest_length
	# The step damps as k h by itself.
	var c = maxf(spring.c - spring.k * h, 0.0) + spring.k * h
	var rod = spring.get("rod", false)
	if w[a] + w[b] == 0.0 or d == Vector2.ZERO or (c == 0.0 and not rod):
		return
	var softness = 0.0 if rod else 1.0 / (h * c)
	var bias = error / h if rod else spring.k * error / c
	rows.append({"a": a, "b": b, "n": d.normalized(), "softness": softness, "bias": bias, "j": 0.0})


func pull(row):
	var u = row.n.dot(v[row.b] - v[row.a])
	var j = -(u + row.bias + row.softness * row.j) / (w[row.a] + w[row.b] + row.softness)
	row.j += j
	v[row.a] -= j * w[row.a] * row.n
	v[row.b] += j * w[row.b] * row.n


# Edges that a disc may reach in this step: direction out, speed to be had, friction; what they have pushed and rubbed.
func add_touches(touches, p):
	for edge in edges:
		var away = x[p] - Geometry2D.get_closest_point_to_segment(x[p], edge[0], edge[1])
		var gap = away.length() - level.particles[p].radius
		if away == Vector2.ZERO or gap > 2.0 * h * (1.0 + v[p].length()):
			continue
		var speed = -gap / h if gap > 0.0 else minf(-gap * OUTWARD, 1.0)
		var friction = sqrt(surface_of(p).friction * edge[2])
		var n = away.normalized()
		touches.append({"p": p, "n": n, "speed": speed, "friction": friction, "pushed": 0.0, "rubbed": 0.0})


func push(touch):
	var tangent = touch.n.orthogonal()
	var pushed = maxf(0.0, touch.pushed + touch.speed - touch.n.dot(v[touch.p]))
	var most = touch.friction * pushed
	var rubbed = clampf(touch.rubbed - tangent.dot(v[touch.p]), -most, most)
	v[touch.p] += (pushed - touch.pushed) * touch.n + (rubbed - touch.rubbed) * tangent
	touch.pushed = pushed
	touch.rubbed = rubbed


func _draw():
	for edge in edges:
		draw_line(edge[0], edge[1], Color.SADDLE_BROWN, 0.03)
	for spring in level.get("springs", []):
		draw_line(x[int(spring.a)], x[int(spring.b)], Color.SLATE_GRAY, 0.01)
	for p in x.size():
		draw_circle(x[p], maxf(level.particles[p].radius, 0.02), Color.TEAL if w[p] == 0.0 else Color.CORAL)
