"""The paper's own method: cages from the contact space of the hand. [Bunis2018]"""
