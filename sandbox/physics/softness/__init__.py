"""How soft is this body: by its firmness, its sag, its slowest wobble and when it buckles; in numbers and in words."""
