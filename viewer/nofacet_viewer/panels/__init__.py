"""What lies before the picture, drawn with imgui: each module is one panel."""
