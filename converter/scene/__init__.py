"""The course's scene format: its data model, parser, writer, and what a scene needs of a renderer."""
