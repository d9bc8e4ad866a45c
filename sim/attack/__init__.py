"""The hand is held at an opening and the object attacked: is it caged?"""
